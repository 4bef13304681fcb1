// File: calibration.h
//
// Reads a Calibration at some number of frames since onset, and makes
// probabilities from log-scores.
//
//   const CalibrationPoint point = CalibrationAt(calibration, frames);
//   BiasAt(calibration.hmm_bias, point, bias);
//   TemperedPosterior(log_prior, log_likelihood, point.hmm_inverse_temperature,
//                     bias, hmm);
//   FusePosteriors(hmm, lstm, point, bias, fused);
//
// Thread-safe: free functions without state. Nothing allocates.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>

#include "core/classify/model.h"

namespace tactus::internal {

// The values of the tables at one number of frames.
struct CalibrationPoint {
  // The point lies between these entries, at this fraction of the way.
  size_t low = 0;
  size_t high = 0;
  double fraction = 0;
  double hmm_inverse_temperature = 1;
  double lstm_inverse_temperature = 1;
  double hmm_weight = 1;
  double lstm_weight = 0;
  double evidence_median = 0;
  double evidence_deviation = 1;
  // Without an estimator no stiffness is too low.
  double softest = -std::numeric_limits<double>::infinity();

  bool operator==(const CalibrationPoint&) const = default;
};

// Interpolates linearly in log(frames) between entries. Before the first entry
// and after the last one their values hold. The calibration must be valid and
// frames >= 1.
CalibrationPoint CalibrationAt(const Calibration& calibration, double frames);

// Reads a table of biases (entries x classes) at a point.
void BiasAt(std::span<const double> table, const CalibrationPoint& point,
            std::span<double> bias);

// probability = softmax(log_prior + inverse_temperature * log_score + bias).
// Classes with a log-score of -infinity get probability 0. If all classes have
// one, the scores say nothing.
void TemperedPosterior(std::span<const double> log_prior,
                       std::span<const double> log_score,
                       double inverse_temperature, std::span<const double> bias,
                       std::span<double> probability);

// fused ~ hmm^hmm_weight * lstm^lstm_weight * exp(bias), normalised. A
// probability below kMinFused counts as kMinFused, so that the zero of one
// model does not overrule the other. A model of weight 0 is not read.
inline constexpr double kMinFused = 1e-300;
void FusePosteriors(std::span<const double> hmm, std::span<const double> lstm,
                    const CalibrationPoint& point, std::span<const double> bias,
                    std::span<double> fused);

// `unknown` is one half if the evidence lies this many deviations below the
// median. One deviation changes the odds by a factor of e.
inline constexpr double kUnknownDeviations = 6;

// `unknown` is also one half for the softest known object. The odds change by a
// factor of e with each 0.05, log10 N/m: half of that stiffness is almost
// certainly unknown.
inline constexpr double kStiffnessDeviation = 0.05;

// Returns the probability that training had nothing like this contact: either
// no class explains it, or its object is softer than those of training. The
// more probable of the two counts. Objects harder than those of training push
// back as the hardest of these do, so they are not told apart. `evidence` is
// the log-likelihood of the best class per HMM step. `log10_stiffness` is the
// estimated stiffness, log10 N/m; nothing without an estimate.
double UnknownProbability(const CalibrationPoint& point, double evidence,
                          std::optional<double> log10_stiffness);

// Returns INVALID_MODEL unless all tables have one finite entry per entry of
// `frames` and the prior has `classes` entries that sum to 1. `softest` may be
// empty.
absl::Status Validate(const Calibration& calibration, int classes,
                      bool has_lstm);

}  // namespace tactus::internal
