// File: skip_rules.h
//
// What a stream need not compute, and how often it did not: one switch and one
// counter a rule. docs/skipping.md tells what each rule is worth and what it
// may change; all but kLstmsAfterDecision change no bit of any answer.
//
//   ContactPipeline::Options options;
//   options.skip[SkipRule::kUnchangedFrames] = false;
//   ...
//   pipeline->skipped()[SkipRule::kUntouchedFrames];
//
// Plain data; thread-safe.
#pragma once

#include <array>
#include <cstdint>

namespace tactus {

enum class SkipRule {
  // Frames outside a contact without a touched taxel: not segmented.
  kUntouchedFrames,
  // Frames of a contact with the taxels of the frame before: features kept.
  kUnchangedFrames,
  // Cues and load profiles that the stream's models do not look at. Counted
  // once: how many cues.
  kUnusedCues,
  // Steps of the LSTMs in a stream that asked for HMMs only.
  kUnaskedLstms,
  // Steps of the LSTMs after the decision in a stream that asked for decisions
  // only.
  kLstmsAfterDecision,
  // Frames that left scores and calibration as they were: probabilities kept.
  kUnchangedScores,
  // Frames of which only the listed taxels were written and checked.
  kUnlistedTaxels,
};
inline constexpr int kSkipRuleCount = 7;

// One Type a rule.
template <typename Type>
class PerSkipRule {
 public:
  constexpr Type& operator[](SkipRule rule) {
    return values_[static_cast<int>(rule)];
  }
  constexpr const Type& operator[](SkipRule rule) const {
    return values_[static_cast<int>(rule)];
  }
  constexpr auto begin() { return values_.begin(); }
  constexpr auto end() { return values_.end(); }

 private:
  std::array<Type, kSkipRuleCount> values_ = {};
};

// All on unless switched off.
class SkipRules : public PerSkipRule<bool> {
 public:
  constexpr SkipRules() {
    for (bool& on : *this) on = true;
  }
};

class SkipCounters : public PerSkipRule<uint64_t> {
 public:
  constexpr SkipCounters& operator+=(const SkipCounters& more) {
    for (int i = 0; i < kSkipRuleCount; ++i) {
      const auto rule = static_cast<SkipRule>(i);
      (*this)[rule] += more[rule];
    }
    return *this;
  }
};

}  // namespace tactus
