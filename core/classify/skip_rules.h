// File: skip_rules.h
//
// Rules that skip work which the answers do not need. Each rule has a switch
// and a counter. They change no bit of any answer. docs/skipping.md states how
// much time each rule saves.
//
//   ContactPipeline::Options options;
//   options.skip[SkipRule::kUnchangedFrames] = false;
//   TACTUS_ASSIGN_OR_RETURN(auto pipeline,
//                           ContactPipeline::Create(layout, model, options));
//   pipeline->skipped()[SkipRule::kUntouchedFrames];
//
// Plain data; thread-safe.
#pragma once

#include <array>
#include <cstdint>

namespace tactus::internal {

enum class SkipRule {
  // Does not segment frames outside a contact without a touched taxel.
  kUntouchedFrames,
  // Keeps the features when a contact's frame has the taxels of the frame
  // before.
  kUnchangedFrames,
  // Does not compute cues and load profiles that the stream's models do not
  // use. The counter is the number of cues, counted once.
  kUnusedCues,
  // Does not step the LSTMs in a stream that asked for HMMs only.
  kUnusedLstms,
  // Keeps the probabilities when neither scores nor calibration have changed.
  kUnchangedScores,
  // Writes and checks only the listed taxels of sparse frames.
  kUnlistedTaxels,
  // Does not sum regions of light touch where no taxel feels enough. The
  // counter is the number of rows of the skin.
  kQuietRows,
};
inline constexpr int kSkipRuleCount = 7;

// One value of Type per rule.
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

// Switches of the rules; all are on by default.
class SkipRules : public PerSkipRule<bool> {
 public:
  constexpr SkipRules() {
    for (bool& on : *this) on = true;
  }
};

// How often each rule skipped work.
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

}  // namespace tactus::internal
