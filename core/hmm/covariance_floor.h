// File: covariance_floor.h
//
// Keeps covariances positive definite: no variance in any direction below a
// floor. Raising the small eigenvalues of a sample covariance is what maximum
// likelihood under that constraint asks for, so Baum-Welch stays monotone.
//
// Thread-safe: a free function.
#pragma once

#include <vector>

#include "core/hmm/gaussian_hmm.h"

namespace tactus {

// Stores `covariance` [D x D, symmetric] as that of `state`, in the model's
// form (spherical: the mean of the variances), eigenvalues or variances raised
// to `floor`; for full covariances also to 1e-10 of the largest eigenvalue, so
// that a Cholesky factor exists in double precision. True if any was raised.
bool SetFlooredCovariance(const std::vector<double>& covariance, double floor,
                          int state, GaussianHmm& model);

}  // namespace tactus
