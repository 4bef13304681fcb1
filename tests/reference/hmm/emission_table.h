// File: emission_table.h
//
// The Gaussian emissions of a model, compiled: Cholesky factors and constants
// are computed once, so that a frame costs a few multiplications per state.
// Used by CompiledHmm; a model must have passed Validate().
//
//   EmissionTable table(model);
//   table.LogDensity(observation, log_density);  // [D] -> [N]
//
// Thread-safe: immutable after construction.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/hmm/gaussian_hmm.h"

namespace tactus::internal {

class EmissionTable {
 public:
  explicit EmissionTable(const GaussianHmm& model);

  // log N(observation; mean, covariance) of every state.
  // observation: [D], out: [N]. Allocates nothing.
  //
  // A Gaussian is nowhere zero, and neither is the result: the squared
  // Mahalanobis distance is held at 1e300 where it would overflow. An
  // observation that is not finite (refused upstream) counts as that far from
  // every state, so it cannot spread.
  void LogDensity(std::span<const double> observation,
                  std::span<double> out) const;

  int states() const { return states_; }
  int dimensions() const { return dimensions_; }

 private:
  // kDimensions 0: any number of them.
  template <int kDimensions, bool kFull>
  void Evaluate(const double* x, double* out) const;

  int states_;
  int dimensions_;
  bool full_;
  size_t block_size_;
  // States in blocks of kLanes, each value repeated for the lanes of its
  // block: per dimension the mean, 1 / L_ii and, if full, L_i0 .. L_i,i-1 of
  // the Cholesky factor L; then the logarithm of the normalising constant.
  std::vector<double> blocks_;
};

}  // namespace tactus::internal
