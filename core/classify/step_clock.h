// File: step_clock.h
//
// StepClock: the schedule by which a model is stepped during a contact.
// Classifying, training and evaluating use this one class, so that a model
// sees the same frames in all three.
//
//   StepClock clock(model.inputs.hmm_steps);
//   for (uint64_t frames = 1; in_contact; ++frames) {
//     if (clock.Tick(frames)) hmms.Step(input);
//   }
//   clock.Reset();  // before the next contact
//
// Owns two numbers. Nothing allocates. Not thread-safe: one per contact.
#pragma once

#include <algorithm>
#include <cstdint>

namespace tactus {

// How often a model is stepped. A contact changes fast at first and slowly
// later, so the interval between two steps is a tenth of the frames since
// onset, but at least `min` and at most `max` frames. 1 and 1 step the model
// on every frame.
struct StepIntervals {
  uint32_t min = 1;
  uint32_t max = 1;

  bool operator==(const StepIntervals&) const = default;

  // The frame of the step after a step at `frames` since onset.
  uint64_t Next(uint64_t frames) const {
    return frames + std::clamp<uint64_t>(frames / 10, min, max);
  }
};

class StepClock {
 public:
  explicit StepClock(const StepIntervals& intervals)
      : intervals_(intervals), due_(intervals.min) {}

  // Starts a new contact.
  void Reset() { due_ = intervals_.min; }

  // Returns true if a step is due at this frame, and schedules the next one.
  // `frames` counts from 1 at onset and increases from call to call.
  bool Tick(uint64_t frames) {
    if (frames < due_) return false;
    due_ = intervals_.Next(frames);
    return true;
  }

  // Skips the steps that were due in the `missing` frames directly before
  // frame `frames`, but at most `limit` of them. Returns how many it skipped.
  int SkipMissing(uint64_t frames, uint64_t missing, int limit) {
    int skipped = 0;
    due_ = std::max(due_, frames - missing);
    while (due_ < frames && skipped < limit) {
      due_ = intervals_.Next(due_);
      ++skipped;
    }
    return skipped;
  }

 private:
  StepIntervals intervals_;
  uint64_t due_;
};

}  // namespace tactus
