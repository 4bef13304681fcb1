// File: trees.h
//
// Trees: extremely randomised trees on the statistics and the stretches of a
// contact so far (touch_history.h), for few trials of one skin. Each tree votes
// for a class. FitTrees (fit_trees.h) makes one.
//
//   TreesScorer scorer(&trees);
//   for (const ContactSample& sample : contact) scorer.Step(sample.loads);
//   scorer.Score(scores);
//
// Source: P. Geurts et al., "Extremely Randomized Trees" (Machine Learning 63,
// 2006).
//
// Trees are plain data. A scorer refers to them; they must be valid and outlive
// it. Its memory is constant and nothing allocates. Not thread-safe: one per
// contact.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "absl/status/status.h"
#include "core/ridge/history_spec.h"
#include "core/ridge/touch_history.h"

namespace tactus::internal {

// Nodes of all trees at most: 24 MB.
inline constexpr size_t kMostTreeNodes = size_t{1} << 21;

struct Trees {
  // Without kernels.
  HistorySpec history;
  int classes = 0;
  // One per node. A node asks whether the number `number` is below `threshold`:
  // if so, `child` is the next node, else the one behind that. A number below 0
  // marks a leaf of the class -1 - number. Children follow their parents.
  std::vector<int32_t> number;
  std::vector<float> threshold;
  std::vector<uint32_t> child;
  // The first node of each tree, rising; the first is 0.
  std::vector<uint32_t> root;
};

// INVALID_MODEL that names what is wrong.
absl::Status Validate(const Trees& trees);

class TreesScorer {
 public:
  explicit TreesScorer(const Trees* trees);

  // Forgets the contact.
  void Reset() { history_.Reset(); }
  // Takes the touched taxels of the next touched frame.
  void Step(std::span<const TaxelLoad> loads) { history_.Step(loads); }
  // Writes the fraction of the trees that vote for each class.
  void Score(std::span<double> scores);

 private:
  const Trees* trees_;
  TouchHistory history_;
  std::vector<float> numbers_;
};

}  // namespace tactus::internal
