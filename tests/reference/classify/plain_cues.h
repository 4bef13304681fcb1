// File: plain_cues.h
//
// The derived cues of a contact in long double, from all of its samples and
// their explicit weights, written from the table of docs/cues.md. The tests
// compare CueTracker with it.
//
//   PlainCues cues(/*sample_rate_hz=*/100);
//   cues.Step(sample, /*frames_since_onset=*/1);
//   const long double cue = cues.Value(NamedCue("log_spring"));
//
// Owns its samples. A step costs time proportional to the contact's length.
// Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "absl/strings/string_view.h"
#include "core/cues/cue.h"

namespace tactus::internal {

class PlainCues {
 public:
  explicit PlainCues(double sample_rate_hz) : rate_(sample_rate_hz) {}

  void Reset() { *this = PlainCues(rate_); }
  void Step(const ContactSample& sample, uint64_t frames_since_onset);

  // A feature or a derived cue; 0 before the first step.
  long double Value(Cue cue) const;

 private:
  // Net force, area, motion and the largest taxel.
  enum Signal { kNet, kAreaOf, kMotionOf, kPeak };
  using Point = std::array<long double, 4>;

  // Weights of the first `count` samples in a running mean over `window`
  // samples: the plain mean until there are as many.
  std::vector<long double> Weights(size_t count, long double window) const;
  // Weighted mean of a signal, and weighted mean product of the deviations of
  // two from their means.
  long double Mean(const std::vector<long double>& weights, Signal a) const;
  long double Covariance(const std::vector<long double>& weights, Signal a,
                         Signal b) const;
  // Running mean over 50 ms after `count` samples.
  long double Smooth(size_t count, Signal a) const;
  // Mean product over all samples so far.
  long double Product(size_t count, Signal a, Signal b) const;
  long double Derive(absl::string_view cue) const;
  long double Level(absl::string_view cue) const;
  long double LogSpring(size_t count) const;
  long double Spring(absl::string_view cue) const;
  long double Window(absl::string_view cue, long double window) const;
  long double Roughness(Signal a, long double floor) const;

  double rate_;
  uint64_t frames_since_onset_ = 0;
  std::vector<Point> points_;
  // After each sample.
  std::vector<long double> smooth_net_;
  std::vector<long double> smooth_area_;
  std::vector<long double> log_spring_;
  // Cues of the last sample.
  mutable std::vector<std::optional<long double>> known_ =
      std::vector<std::optional<long double>>(CueCount());
};

}  // namespace tactus::internal
