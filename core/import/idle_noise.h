// File: idle_noise.h
//
// What an untouched skin reports, and the thresholds that follow from it:
//
//   q = 99.9th percentile of the idle loads of all taxels
//   margin = the larger of (q - median of them) / 2
//            and 2 % of the median trial's largest value
//   contact_threshold = q + margin, onset_threshold = contact_threshold +
//   margin
//
//   IdleNoise noise({.frames = 10});
//   for (const Trial& trial : trials) noise.Add(trial);
//   TACTUS_ASSIGN_OR_RETURN(const IdleEstimate found, noise.Estimate());
//
// Memory is bounded: beyond 4 million values every second one is kept, then
// every fourth, and so on. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/data/trial.h"

namespace tactus::internal {

// Which values are idle. One of the two is above 0.
struct IdleValues {
  // Those of all taxels in this many first frames of each trial.
  int frames = 0;
  // Those of this fraction of the taxels, the ones with the smallest mean in
  // the trial. For recordings that begin in contact.
  double taxels = 0;
};

struct IdleEstimate {
  size_t values = 0;
  double median = 0;
  double percentile_999 = 0;
  double largest = 0;
  // Median over trials of the largest value of all taxels and frames.
  double peak = 0;
  double margin = 0;
  double contact_threshold = 0;
  double onset_threshold = 0;
};

class IdleNoise {
 public:
  explicit IdleNoise(const IdleValues& which) : which_(which) {}

  // Takes the loads of a trial's taxels, those that `trial.skin` masks
  // excepted.
  void Add(const Trial& trial);

  // INVALID_TRAINING_DATA if there are no values, or if the contact threshold
  // would be above half of the peak: then the idle values are not idle.
  absl::StatusOr<IdleEstimate> Estimate() const;

 private:
  void Keep(float value);

  IdleValues which_;
  std::vector<float> values_;
  uint64_t seen_ = 0;
  uint64_t stride_ = 1;
  std::vector<float> peaks_;
};

}  // namespace tactus::internal
