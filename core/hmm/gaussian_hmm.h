// File: gaussian_hmm.h
//
// A hidden Markov model with one multivariate Gaussian emission per state, as
// plain data (Rabiner, Proc. IEEE 1989, Sections III and IV.A; the paper's
// Section "Hidden Markov Models"). BaumWelch trains it, bundles store it, and
// HmmBank scores observations with it.
//
//   GaussianHmm model = *InitPaper(sequences, {});
//   TACTUS_RETURN_IF_ERROR(Validate(model));
//   TACTUS_ASSIGN_OR_RETURN(HmmBank bank, HmmBank::Create(mixtures));
//
// Plain data; thread-safe while no thread writes to it.
#pragma once

#include <cstddef>
#include <vector>

#include "absl/status/status.h"

namespace tactus::internal {

enum class CovarianceType { kFull = 0, kDiagonal = 1, kSpherical = 2 };

// N states, D dimensions; units are those of the (scaled) observations.
struct GaussianHmm {
  int states = 0;      // N: 1 .. limits::kMaxHmmStates
  int dimensions = 0;  // D: 1 .. limits::kMaxHmmDimensions
  CovarianceType covariance_type = CovarianceType::kFull;
  std::vector<double> start;        // [N] sums to 1
  std::vector<double> transition;   // [N x N] row-major, rows sum to 1
  std::vector<double> means;        // [N x D]
  std::vector<double> covariances;  // full [N x D x D], diagonal [N x D],
                                    // spherical [N]
};

// Entries of one state's covariance: D * D, D or 1.
size_t CovarianceSize(CovarianceType type, int dimensions);

// INVALID_MODEL, with the field's name, if a size is out of limits, an entry is
// not finite, a probability is negative, probabilities do not sum to 1 within
// 1e-9, or a covariance is not symmetric positive definite.
absl::Status Validate(const GaussianHmm& model);

// The same model with every covariance in the form `type`. Entries that the
// form does not have are dropped; the spherical form has the mean of the
// variances.
GaussianHmm WithCovarianceType(const GaussianHmm& model, CovarianceType type);

// Writes the covariance of `state` in full, row-major, to `out` [D x D].
void FullCovariance(const GaussianHmm& model, int state, double* out);

}  // namespace tactus::internal
