// File: hmm_scores.h
//
// Sequences of observations and their log-likelihoods under the HMMs of a
// model, by the reference implementation in double precision. Test-only.
//
//   for (const HmmSequence& sequence : HmmSequences(HmmSample())) {
//     sequence.log_likelihood[k];
//   }
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/core/interchange/samples.h"
#include "tests/reference/hmm/forward_filter.h"

namespace tactus::internal {

struct HmmSequence {
  // [T][D].
  Rows observations;
  // One per class.
  std::vector<double> log_likelihood;
};

// log sum_k weight_k p(o | hmm_k).
inline double LogLikelihood(const HmmMixture& mixture,
                            const Rows& observations) {
  std::vector<double> terms;
  for (size_t k = 0; k < mixture.components.size(); ++k) {
    const CompiledHmm hmm = *CompiledHmm::Create(mixture.components[k]);
    ForwardFilter filter(hmm);
    for (const std::vector<double>& row : observations) filter.Step(row);
    terms.push_back(mixture.log_weight[k] + filter.log_likelihood());
  }
  const double best = *std::max_element(terms.begin(), terms.end());
  double sum = 0;
  for (const double term : terms) sum += std::exp(term - best);
  return best + std::log(sum);
}

// One sequence per class, of different lengths.
inline std::vector<HmmSequence> HmmSequences(const Model& model) {
  constexpr int kFrames = 60;
  std::vector<HmmSequence> sequences;
  for (size_t k = 0; k < model.hmms.size(); ++k) {
    const size_t d = model.hmms[k].components.front().dimensions;
    const std::vector<double> flat =
        HmmObservations(model, k, kFrames + 7 * static_cast<int>(k));
    HmmSequence& sequence = sequences.emplace_back();
    for (size_t t = 0; t + d <= flat.size(); t += d) {
      const auto begin = flat.begin() + static_cast<ptrdiff_t>(t);
      sequence.observations.emplace_back(begin,
                                         begin + static_cast<ptrdiff_t>(d));
    }
    for (const HmmMixture& mixture : model.hmms) {
      sequence.log_likelihood.push_back(
          LogLikelihood(mixture, sequence.observations));
    }
  }
  return sequences;
}

}  // namespace tactus::internal
