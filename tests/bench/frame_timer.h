// File: frame_timer.h
//
// FrameTimer: processor time of a frame, apart for the frames before the onset
// and those after it.
//
//   FrameTimer timer(trials);
//   timer.Run(n, [&] { pipeline->EndTrial(); },
//             [&](int t) { pipeline->Step(trials[n].frame(t)); });
//   timer.Result().contact;  // timer.Of(n).contact
//
// Keeps a reference to the trials. Not thread-safe.
#pragma once

#include <vector>

#include "tests/bench/rendered_frames.h"
#include "tests/bench/timing.h"

namespace tactus::internal::client {

// Nanoseconds of a frame before the onset and of one after it, each from the
// medians of the trials' runs.
struct FrameTimes {
  double idle = 0;
  double contact = 0;
};

// Runs the trials in turns through each of several parts of the path.
class FrameTimer {
 public:
  explicit FrameTimer(const std::vector<RenderedTrial>& trials)
      : trials_(&trials), idle_(trials.size()), contact_(trials.size()) {}

  // `reset` before and `step` on each frame of a trial.
  template <typename Reset, typename Step>
  void Run(size_t trial, const Reset& reset, const Step& step) {
    const RenderedTrial& frames = (*trials_)[trial];
    reset();
    int t = 0;
    const auto time = [&](int end) {
      const double start = ThreadSeconds();
      for (; t < end; ++t) step(t);
      return ThreadSeconds() - start;
    };
    idle_[trial].push_back(time(frames.lead_in));
    contact_[trial].push_back(time(frames.frames()));
  }

  // Over all trials, and of one of them.
  FrameTimes Result() const { return Between(0, trials_->size()); }
  FrameTimes Of(size_t trial) const { return Between(trial, trial + 1); }

 private:
  FrameTimes Between(size_t first, size_t end) const {
    FrameTimes times;
    double idle_frames = 0;
    double contact_frames = 0;
    for (size_t i = first; i < end; ++i) {
      times.idle += Percentile(idle_[i], 0.5);
      times.contact += Percentile(contact_[i], 0.5);
      idle_frames += (*trials_)[i].lead_in;
      contact_frames += (*trials_)[i].frames() - (*trials_)[i].lead_in;
    }
    times.idle *= 1e9 / idle_frames;
    times.contact *= 1e9 / contact_frames;
    return times;
  }

  const std::vector<RenderedTrial>* trials_;
  std::vector<std::vector<double>> idle_;
  std::vector<std::vector<double>> contact_;
};

}  // namespace tactus::internal::client
