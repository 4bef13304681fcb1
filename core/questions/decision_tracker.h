// File: decision_tracker.h
//
// DecisionTracker: the decisions of one contact, one per question. A question
// is decided when one value has had at least the threshold's probability for
// enough frames and the contact is not unknown. Later another value may do the
// same: then a state has changed, and a property is revised.
//
//   DecisionTracker tracker({{Question::kState, 0.95, 10}});
//   for (uint64_t frame = 1; frame <= frames; ++frame) {
//     tracker.Step(0, value_probability, unknown, frame);
//   }
//   if (tracker.decisions()[0].decided()) Report(tracker.decisions()[0].value);
//
// Owns its state; nothing allocates after construction. Not thread-safe: one
// per stream.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/questions/question.h"

namespace tactus::internal {

// When a question is decided.
struct DecisionRule {
  Question::Kind kind = Question::kProperty;
  // Above 0.5, so that only one value can reach it.
  double threshold = 0;
  // Frames in a row, at least 1.
  uint32_t frames = 1;
};

// The decision on one question. Frames are counted since onset, from 1.
struct QuestionDecision {
  // Index into Question::values; of no meaning before the decision.
  int value = 0;
  // The frame of the first decision; 0 before it.
  uint64_t frame = 0;
  // The frame of the last change of `value`; 0 if it has not changed.
  uint64_t changed_frame = 0;
  uint32_t changes = 0;
  // True if the question is a property and its decision was changed: one of
  // the two values was wrong.
  bool revised = false;

  bool decided() const { return frame > 0; }
};

// What a frame did to a decision.
enum class DecisionEvent { kNone, kDecided, kChanged };

// What happened at `frame`.
DecisionEvent EventAt(const QuestionDecision& decision, uint64_t frame);

class DecisionTracker {
 public:
  // A contact whose `unknown` is at least this is not decided.
  static constexpr double kUnknown = 0.5;

  // One rule per question.
  explicit DecisionTracker(std::vector<DecisionRule> rules);

  // Forgets the contact.
  void Reset();

  // Takes the probabilities of the values of one question at `frame`, which is
  // above that of the step before. Returns what it did to the decision.
  DecisionEvent Step(size_t question, std::span<const double> value_probability,
                     double unknown, uint64_t frame);

  std::span<const QuestionDecision> decisions() const { return decisions_; }

 private:
  // Frames in a row in which `value` reached the threshold.
  struct Run {
    int value = 0;
    uint32_t frames = 0;
  };

  std::vector<DecisionRule> rules_;
  std::vector<Run> runs_;
  std::vector<QuestionDecision> decisions_;
};

}  // namespace tactus::internal
