// File: softmax_fit.h
//
// Multinomial logistic regression of classes on the scores of several models:
// p = softmax(sum over models of weight x score + bias). The mean log loss of
// the labels is convex in weights and biases, so the fit is the best one.
//
//   const SoftmaxFit fit = FitSoftmax(contacts, bounds, classes);
//   fit.weights[0];
//
// Weights stay within bounds, so that separable data do not make them infinite.
// A prior holds biases at 0: each has the variance 1, which few contacts do not
// outweigh.
//
// Thread-safe: free functions without state.
#pragma once

#include <span>
#include <vector>

namespace tactus::internal {

struct ScoredLabel {
  int label = 0;
  // [models][classes]; -infinity counts as a very low score.
  std::vector<std::span<const double>> scores;
};

struct WeightBounds {
  double min = 0;
  double max = 1;
};

struct SoftmaxFit {
  std::vector<double> weights;  // one per model
  std::vector<double> bias;     // one per class
};

// Projected Newton steps (Bertsekas, SIAM J. Control Optim. 20, 1982) from the
// middle of the bounds. `contacts` must not be empty.
SoftmaxFit FitSoftmax(std::span<const ScoredLabel> contacts,
                      std::span<const WeightBounds> bounds, int classes);

// -log(probability of the label).
double LogLoss(const SoftmaxFit& fit, const ScoredLabel& contact);

}  // namespace tactus::internal
