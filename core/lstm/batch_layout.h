// File: batch_layout.h
//
// The order of a batch's steps in one array of rows. Sequences are sorted by
// length, longest first. First come the rows of step 0, one per sequence, then
// those of step 1 of every sequence that has one, and so on. So products over
// all steps need no padding.
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

namespace tactus::internal {

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

  // Per position: the index of the sequence, and its number of steps.
  std::vector<int> order;
  std::vector<int> steps;
  // Per step: the number of sequences that reach it, and the row of the first.
  std::vector<int> active;
  std::vector<int> first;
  int rows = 0;
};

}  // namespace tactus::internal
