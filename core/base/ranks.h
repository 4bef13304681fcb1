// File: ranks.h
//
// Ranks: processes that make one result together. Each has the whole input,
// does its share of the work, and gives the others what it made. As the threads
// of a ParallelFor, they are lent to core by its caller.
//
//   OneRank alone;
//   Ranks& ranks = alone;
//   const std::vector<double> weights = {3, 1, 1};
//   const std::vector<int> owner = ShareOut(weights, ranks.size());
//   std::string made;
//   for (int i = 0; i < 3; ++i) {
//     if (owner[i] == ranks.rank()) made += Make(i);
//   }
//   TACTUS_ASSIGN_OR_RETURN(const std::vector<std::string> all,
//                           ranks.Exchange(made));
//
// What a rank does between two exchanges must follow from the common input and
// from what was exchanged, so that all ranks exchange equally often.
//
// Not thread-safe: one thread exchanges.
#pragma once

#include <algorithm>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace tactus::internal {

class Ranks {
 public:
  virtual ~Ranks() = default;

  // 0 to size() - 1.
  virtual int rank() const = 0;
  virtual int size() const = 0;

  // Gives `mine` to all ranks, waits for theirs, and returns them in the order
  // of their ranks. If a rank gives an error, all ranks get it, that of the
  // lowest rank if several do; it is returned by all later calls too.
  virtual absl::StatusOr<std::vector<std::string>> Exchange(
      const absl::StatusOr<std::string>& mine) = 0;
};

// A process that works alone.
class OneRank final : public Ranks {
 public:
  int rank() const override { return 0; }
  int size() const override { return 1; }
  absl::StatusOr<std::vector<std::string>> Exchange(
      const absl::StatusOr<std::string>& mine) override {
    if (!mine.ok()) return mine.status();
    return std::vector<std::string>{*mine};
  }
};

// The rank that does each task, by what the tasks weigh: the heaviest first,
// each to the rank that has least so far.
inline std::vector<int> ShareOut(std::span<const double> weights, int ranks) {
  std::vector<size_t> order(weights.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(
      order, [&](size_t a, size_t b) { return weights[a] > weights[b]; });
  std::vector<int> owner(weights.size());
  std::vector<double> load(ranks);
  for (const size_t task : order) {
    const auto least = std::ranges::min_element(load);
    owner[task] = static_cast<int>(least - load.begin());
    *least += weights[task];
  }
  return owner;
}

}  // namespace tactus::internal
