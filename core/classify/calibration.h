// File: calibration.h
//
// Reads a Calibration at some number of frames since onset, and makes
// probabilities from log-scores.
//
//   const CalibrationPoint point = CalibrationAt(calibration, frames);
//   TemperedPosterior(log_prior, log_likelihood, point.hmm_inverse_temperature,
//   hmm); FusePosteriors(hmm, lstm, point.lstm_weight, fused);
//
// Thread-safe: free functions without state. Nothing allocates.
#pragma once

#include <span>

#include "core/classify/model.h"

namespace tactus {

// The values of the tables at one number of frames.
struct CalibrationPoint {
  double hmm_inverse_temperature = 1;
  double lstm_inverse_temperature = 1;
  double lstm_weight = 0;
  double evidence_median = 0;
  double evidence_deviation = 1;

  bool operator==(const CalibrationPoint&) const = default;
};

// Interpolates linearly in log(frames) between entries. Before the first entry
// and after the last one their values hold. The calibration must be valid and
// frames >= 1.
CalibrationPoint CalibrationAt(const Calibration& calibration, double frames);

// probability = softmax(log_prior + inverse_temperature * log_score). Classes
// with a log-score of -infinity get probability 0. If all classes have one, the
// result is the prior.
void TemperedPosterior(std::span<const double> log_prior,
                       std::span<const double> log_score,
                       double inverse_temperature,
                       std::span<double> probability);

// fused ~ hmm^(1 - weight) * lstm^weight, normalised.
void FusePosteriors(std::span<const double> hmm, std::span<const double> lstm,
                    double weight, std::span<double> fused);

// `unknown` is one half if the evidence lies this many deviations below the
// median. One deviation changes the odds by a factor of e.
inline constexpr double kUnknownDeviations = 6;

// Returns the probability that no class explains the contact. `evidence` is the
// log-likelihood of the best class per HMM step; the calibration holds its
// median over training contacts.
double UnknownProbability(const CalibrationPoint& point, double evidence);

// Returns INVALID_MODEL unless all tables have one finite entry per entry of
// `frames` and the prior has `classes` entries that sum to 1.
absl::Status Validate(const Calibration& calibration, int classes,
                      bool has_lstm);

}  // namespace tactus
