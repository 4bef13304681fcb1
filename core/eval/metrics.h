// File: metrics.h
//
// Numbers that sum up an evaluation: confusion, accuracy with its interval,
// calibration error, errors of estimates.
//
//   const int right = CountRight(outcomes);
//   const Interval interval = WilsonInterval(right, outcomes.size());
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <span>
#include <vector>

#include "core/base/wilson_interval.h"

namespace tactus::internal {

// One classified contact.
struct Outcome {
  int label = 0;
  // Per class; sums to 1.
  std::vector<double> probability;

  int answer() const;
};

// [label][answer] counts, classes x classes.
using Confusion = std::vector<std::vector<int>>;
Confusion CountConfusion(std::span<const Outcome> outcomes, int classes);

// Number of outcomes whose answer is their label.
int CountRight(std::span<const Outcome> outcomes);

// Fraction of outcomes whose answer is their label; 0 without outcomes.
double Accuracy(std::span<const Outcome> outcomes);

// Expected calibration error: mean over 15 equal-width bins of the top
// probability, weighted by size, of |accuracy - mean probability|
// (Guo et al., ICML 2017, eq. 3). 0 for none.
double ExpectedCalibrationError(std::span<const Outcome> outcomes);

// The answers that are given if only sure ones are: those to contacts whose
// probability of being unknown is below 0.5 and whose top probability is at
// least `least`.
struct SureAnswers {
  int count = 0;
  int right = 0;
};
// `unknown` has one probability per outcome.
SureAnswers CountSure(std::span<const Outcome> outcomes,
                      std::span<const double> unknown, double least);

// The top probabilities of the right answers, or of the wrong ones.
std::vector<double> TopProbabilities(std::span<const Outcome> outcomes,
                                     bool right);

// Mean of -log(probability of the label), each probability at least 1e-12, and
// mean of the squared distance of the probabilities from the label (Brier,
// 1950): 0 to 2. 0 without outcomes.
double MeanLogLoss(std::span<const Outcome> outcomes);
double BrierScore(std::span<const Outcome> outcomes);

// A summary of the errors of estimates with a Gaussian uncertainty.
struct EstimateErrors {
  int count = 0;
  double median = 0;  // of the absolute errors
  double root_mean_square = 0;
  // Fraction of errors within one estimated standard deviation; 0.68 if the
  // deviations are right.
  double covered = 0;
};
struct EstimateError {
  double error = 0;
  double deviation = 0;
};
EstimateErrors SummariseErrors(std::span<const EstimateError> errors);

}  // namespace tactus::internal
