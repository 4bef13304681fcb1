// File: calibration.h
//
// Reading a Calibration at some number of frames since onset, and the steps
// from log-scores to probabilities.
//
// Thread-safe: free functions without state. Nothing allocates.
#pragma once

#include <span>

#include "core/classify/model.h"

namespace tactus {

// The tables' values at one number of frames.
struct CalibrationPoint {
  double hmm_temperature = 1;
  double lstm_temperature = 1;
  double lstm_weight = 0;
  double evidence_mean = 0;
  double evidence_deviation = 1;

  bool operator==(const CalibrationPoint&) const = default;
};

// Linear in log(frames) between entries, held outside. The calibration must
// be valid and frames >= 1.
CalibrationPoint CalibrationAt(const Calibration& calibration, double frames);

// probability = softmax(log_prior + temperature * log_score). Log-scores of
// -infinity get probability 0; if all are, the prior.
void TemperedPosterior(std::span<const double> log_prior,
                       std::span<const double> log_score, double temperature,
                       std::span<double> probability);

// fused ~ hmm^(1 - weight) * lstm^weight, normalised.
void FusePosteriors(std::span<const double> hmm, std::span<const double> lstm,
                    double weight, std::span<double> fused);

// A contact is as likely unknown as not when its evidence lies this many
// deviations below what is typical; one deviation is e-fold.
inline constexpr double kUnknownDeviations = 6;

// Probability that the contact is of no known kind, from how far its best
// log-likelihood per HMM step lies below that of training contacts.
double UnknownShare(const CalibrationPoint& point, double evidence);

// INVALID_MODEL unless all tables have one finite entry per frame count and
// the prior has `classes` entries that sum to 1.
absl::Status Validate(const Calibration& calibration, int classes,
                      bool has_lstm);

}  // namespace tactus
