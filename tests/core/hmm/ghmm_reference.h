// File: ghmm_reference.h
//
// Scores and trains a GaussianHmm with libghmm, the General Hidden Markov
// Model library, which the paper used: the independent reference for core/hmm.
//
// Not thread-safe: libghmm keeps global state.
#pragma once

#include <vector>

#include "core/hmm/gaussian_hmm.h"

namespace tactus {

struct GhmmScores {
  double log_likelihood = 0;
  double viterbi = 0;
};

// observations: [frames x D].
GhmmScores ScoreWithGhmm(const GaussianHmm& model,
                         const std::vector<double>& observations);

// The model after one Baum-Welch update over `sequences`, each [frames x D].
// libghmm takes moments about the old means; the covariances returned are
// about the new ones.
GaussianHmm TrainOnceWithGhmm(
    const GaussianHmm& model,
    const std::vector<std::vector<double>>& sequences);

}  // namespace tactus
