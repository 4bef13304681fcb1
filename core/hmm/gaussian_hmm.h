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
// Thread-safe while nobody writes to it, like any plain data.
#pragma once

#include <cstddef>
#include <vector>

#include "absl/status/status.h"

namespace tactus {

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

// Refuses with INVALID_MODEL, naming the field: sizes out of limits, entries
// that are not finite, probabilities that are negative or do not sum to 1
// within 1e-9, covariances that are not symmetric positive definite.
absl::Status Validate(const GaussianHmm& model);

// The same model with every covariance in the form `type`. Entries the form
// cannot hold are dropped; spherical keeps the mean of the variances.
GaussianHmm WithCovarianceType(const GaussianHmm& model, CovarianceType type);

// Writes the covariance of `state` in full, row-major, to `out` [D x D].
void FullCovariance(const GaussianHmm& model, int state, double* out);

}  // namespace tactus
