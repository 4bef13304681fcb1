#include "core/questions/decision_tracker.h"

#include <algorithm>
#include <utility>

namespace tactus::internal {

DecisionEvent EventAt(const QuestionDecision& decision, uint64_t frame) {
  if (frame == 0) return DecisionEvent::kNone;
  if (decision.frame == frame) return DecisionEvent::kDecided;
  return decision.changed_frame == frame ? DecisionEvent::kChanged
                                         : DecisionEvent::kNone;
}

DecisionTracker::DecisionTracker(std::vector<DecisionRule> rules)
    : rules_(std::move(rules)),
      runs_(rules_.size()),
      decisions_(rules_.size()) {}

void DecisionTracker::Reset() {
  std::ranges::fill(runs_, Run{});
  std::ranges::fill(decisions_, QuestionDecision{});
}

DecisionEvent DecisionTracker::Step(size_t question,
                                    std::span<const double> value_probability,
                                    double unknown, uint64_t frame) {
  const DecisionRule& rule = rules_[question];
  const auto best = std::ranges::max_element(value_probability);
  const int value = static_cast<int>(best - value_probability.begin());
  Run& run = runs_[question];
  if (*best < rule.threshold || unknown >= kUnknown) {
    run.frames = 0;
    return DecisionEvent::kNone;
  }
  if (value != run.value) run = {value, 0};
  // Stops counting, so that it never overflows.
  run.frames = std::min(run.frames + 1, rule.frames);
  if (run.frames < rule.frames) return DecisionEvent::kNone;
  QuestionDecision& decision = decisions_[question];
  if (!decision.decided()) {
    decision.value = value;
    decision.frame = frame;
    return DecisionEvent::kDecided;
  }
  if (value == decision.value) return DecisionEvent::kNone;
  decision.value = value;
  decision.changed_frame = frame;
  ++decision.changes;
  decision.revised = rule.kind == Question::kProperty;
  return DecisionEvent::kChanged;
}

}  // namespace tactus::internal
