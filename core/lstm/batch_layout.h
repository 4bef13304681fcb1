// File: batch_layout.h
//
// Where the steps of a batch of sequences lie in one array of rows: longest
// sequence first, a row each for step 0, then as many rows for step 1 as
// sequences reach it, and so on. Products over all steps take no padding.
//
//   const int steps[] = {4, 9, 9};
//   BatchLayout layout;
//   layout.Arrange(steps);  // 9 + 9 + 4 rows, in the order 1, 2, 0
//
// Not thread-safe.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

namespace tactus {

struct BatchLayout {
  void Arrange(std::span<const int> steps_of) {
    order.resize(steps_of.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      return steps_of[a] != steps_of[b] ? steps_of[a] > steps_of[b] : a < b;
    });
    steps.clear();
    for (const int i : order) steps.push_back(steps_of[i]);
    active.clear();
    first.clear();
    rows = 0;
    int reaching = static_cast<int>(order.size());
    for (int t = 0; t < steps.front(); ++t) {
      while (steps[reaching - 1] <= t) --reaching;
      active.push_back(reaching);
      first.push_back(rows);
      rows += reaching;
    }
  }

  int sequences() const { return static_cast<int>(order.size()); }
  ptrdiff_t Row(int t, int position) const { return first[t] + position; }

  // Per position: which sequence, and its steps.
  std::vector<int> order;
  std::vector<int> steps;
  // Per step: how many sequences reach it, and the row of the first.
  std::vector<int> active;
  std::vector<int> first;
  int rows = 0;
};

}  // namespace tactus
