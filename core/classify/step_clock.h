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

namespace tactus::internal {

// How often a model is stepped. A contact changes fast at first and slowly
// later, so the interval between two steps is a fraction of the frames since
// onset, but at least `min` and at most `max` frames. 1 and 1 step the model
// on every frame.
struct StepIntervals {
  uint32_t min = 1;
  uint32_t max = 1;
  // The frame of the first step, at most `min`; 0 stands for `min`. If there is
  // one, an interval is also at most half of the frames since onset, or 1: from
  // frame 1 on, steps are at 1, 2, 3, 4, 6, 9, ...
  uint32_t first = 0;
  // The interval is the frames since onset over this; at least 2.
  uint32_t divisor = 10;

  bool operator==(const StepIntervals&) const = default;

  uint64_t First() const { return first > 0 ? first : min; }

  // The frame of the step after a step at `frames` since onset.
  uint64_t Next(uint64_t frames) const {
    const uint64_t interval = std::clamp<uint64_t>(frames / divisor, min, max);
    if (first == 0) return frames + interval;
    return frames + std::min(interval, std::max<uint64_t>(frames / 2, 1));
  }
};

class StepClock {
 public:
  explicit StepClock(const StepIntervals& intervals)
      : intervals_(intervals), due_(intervals.First()) {}

  // Starts a new contact.
  void Reset() { due_ = intervals_.First(); }

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

}  // namespace tactus::internal
