// File: hmm_models.h
//
// Seeded models and trials for the HMM benchmarks: left-right models with full
// covariances, as the default bundle has them, and a reference score.
//
//   Random random(1);
//   const GaussianHmm model = DrawLeftRightModel(10, 3, random);
//   const std::vector<double> trial = DrawTrial(model, 1000, random);
//
// Thread-safe, except for the caller's Random.
#pragma once

#include <vector>

#include "core/base/random.h"
#include "core/hmm/gaussian_hmm.h"
#include "core/hmm/mixture.h"

namespace tactus::internal::client {

// A model in which a state stays or moves to the next. Features are of order 1
// and correlated.
GaussianHmm DrawLeftRightModel(int states, int dimensions, Random& random);

// `frames` observations of the model [frames x D]. Each state lasts equally
// long.
std::vector<double> DrawTrial(const GaussianHmm& model, int frames,
                              Random& random);

// log p(observations) of the model, or the score of its best path, computed in
// logarithms of long double.
long double ReferenceScore(const GaussianHmm& model, Score score,
                           const std::vector<double>& observations);

}  // namespace tactus::internal::client
