// File: floored_covariance.h
//
// Stores an estimated covariance in a model, with a floor under its
// eigenvalues.
//
//   const bool raised =
//       SetFlooredCovariance(covariance, /*floor=*/1e-6, state, model);
//
// Thread-safe: a free function without state.
#pragma once

#include <vector>

#include "core/hmm/gaussian_hmm.h"

namespace tactus::internal {

// Stores `covariance` [D x D, symmetric] as that of `state`, in the model's
// form (spherical: the mean of the variances). Raises eigenvalues or variances
// below `floor` to `floor`, and for full covariances also to 1e-10 of the
// largest eigenvalue, so that a Cholesky factor exists in double precision.
// This is the maximum-likelihood estimate under that constraint, so Baum-Welch
// stays monotone. Returns true if any value was raised.
bool SetFlooredCovariance(const std::vector<double>& covariance, double floor,
                          int state, GaussianHmm& model);

}  // namespace tactus::internal
