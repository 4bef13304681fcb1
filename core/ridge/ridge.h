// File: ridge.h
//
// A linear classifier of a whole contact so far, for few trials of one skin:
// the numbers of a TouchHistory, standardised, times the weights of each class.
// FitRidge (fit_ridge.h) makes one.
//
//   RidgeScorer scorer(&ridge);
//   for (const ContactSample& sample : contact) scorer.Step(sample.loads);
//   scorer.Score(scores);
//
// A Ridge is plain data. A scorer refers to one, which must be valid and
// outlive it; its memory is constant and nothing allocates. Not thread-safe:
// one per contact.
#pragma once

#include <span>
#include <vector>

#include "absl/status/status.h"
#include "core/ridge/history_spec.h"
#include "core/ridge/touch_history.h"

namespace tactus::internal {

// Standardised numbers are within plus and minus this, so that a skin that
// reads unlike any of training does not decide by one number.
inline constexpr float kRidgeLimit = 5;

struct Ridge {
  HistorySpec history;
  // A number x is taken as (x - offset) * gain. One per number.
  std::vector<float> offset;
  std::vector<float> gain;
  // [classes][numbers], and one per class.
  std::vector<float> weight;
  std::vector<float> bias;

  int classes() const { return static_cast<int>(bias.size()); }
};

// INVALID_MODEL that names what is wrong.
absl::Status Validate(const Ridge& ridge);

class RidgeScorer {
 public:
  explicit RidgeScorer(const Ridge* ridge);

  // Forgets the contact.
  void Reset() { history_.Reset(); }
  // Takes the touched taxels of the next touched frame.
  void Step(std::span<const TaxelLoad> loads) { history_.Step(loads); }
  // Writes a score per class: about 1 for the class of the contact, about 0 for
  // the others.
  void Score(std::span<double> scores);

 private:
  const Ridge* ridge_;
  TouchHistory history_;
  // Numbers of one part of the history.
  std::vector<float> numbers_;
};

}  // namespace tactus::internal
