#include "core/train/softmax_fit.h"

#include <algorithm>
#include <cmath>

#include "Eigen/Cholesky"
#include "Eigen/Core"

namespace tactus::internal {
namespace {

constexpr int kMaxIterations = 50;
constexpr int kMaxHalvings = 30;
// Relative fall of the loss below which the fit has converged.
constexpr double kConverged = 1e-10;
constexpr double kLowestScore = -1e6;
constexpr double kBiasVariance = 1;

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Relative to the best class; `out` has an entry per class, `stride` apart.
void CopyScores(std::span<const double> scores, size_t stride, double* out) {
  const double top = *std::ranges::max_element(scores);
  for (size_t k = 0; k < scores.size(); ++k) {
    // All -infinity: no class is preferred.
    out[k * stride] =
        std::isfinite(top) ? std::max(scores[k] - top, kLowestScore) : 0;
  }
}

// Parameters are the weights, then the biases.
class Problem {
 public:
  Problem(std::span<const ScoredLabel> contacts, int models, int classes)
      : models_(models),
        classes_(classes),
        scores_(contacts.size() * classes * models),
        p_(classes),
        mean_(models),
        centred_(models * classes) {
    for (size_t i = 0; i < contacts.size(); ++i) {
      labels_.push_back(contacts[i].label);
      for (int m = 0; m < models; ++m) {
        CopyScores(contacts[i].scores[m], models, &scores_[At(i)] + m);
      }
    }
  }

  int size() const { return models_ + classes_; }

  // The mean log loss with the prior of the biases.
  double Loss(const VectorXd& x) {
    double loss = 0;
    for (size_t i = 0; i < labels_.size(); ++i) loss += LossOf(i, x);
    return loss / count() + 0.5 / count() * Penalty(x);
  }

  // The same and its derivatives; of the Hessian, the lower triangle.
  double Loss(const VectorXd& x, VectorXd& gradient, MatrixXd& hessian) {
    gradient.setZero(size());
    hessian.setZero(size(), size());
    double loss = 0;
    for (size_t i = 0; i < labels_.size(); ++i) {
      loss += LossOf(i, x);
      AddDerivatives(i, gradient, hessian);
    }
    for (int k = models_; k < size(); ++k) {
      gradient[k] += x[k] / kBiasVariance;
      hessian(k, k) += 1 / kBiasVariance;
    }
    gradient /= count();
    hessian /= count();
    return loss / count() + 0.5 / count() * Penalty(x);
  }

  // Loss of one contact, without the prior. Leaves its probabilities in p_.
  double LossOf(size_t i, const VectorXd& x) {
    const double* scores = &scores_[At(i)];
    for (int k = 0; k < classes_; ++k) {
      p_[k] = x[models_ + k];
      for (int m = 0; m < models_; ++m) p_[k] += x[m] * scores[k * models_ + m];
    }
    const double top = *std::ranges::max_element(p_);
    const double label = p_[labels_[i]] - top;
    double sum = 0;
    for (double& p : p_) sum += p = std::exp(p - top);
    for (double& p : p_) p /= sum;
    return std::log(sum) - label;
  }

 private:
  size_t At(size_t i) const { return i * classes_ * models_; }
  double count() const { return static_cast<double>(labels_.size()); }
  double Penalty(const VectorXd& x) const {
    return x.tail(classes_).squaredNorm() / kBiasVariance;
  }

  // Uses p_.
  void AddDerivatives(size_t i, VectorXd& gradient, MatrixXd& hessian) {
    const double* scores = &scores_[At(i)];
    for (int m = 0; m < models_; ++m) {
      mean_[m] = 0;
      for (int k = 0; k < classes_; ++k) {
        mean_[m] += p_[k] * scores[k * models_ + m];
      }
      gradient[m] += mean_[m] - scores[labels_[i] * models_ + m];
      for (int k = 0; k < classes_; ++k) {
        centred_[m * classes_ + k] = scores[k * models_ + m] - mean_[m];
      }
    }
    for (int k = 0; k < classes_; ++k) {
      gradient[models_ + k] += p_[k] - (k == labels_[i] ? 1 : 0);
      for (int m = 0; m < models_; ++m) {
        const double weighted = p_[k] * centred_[m * classes_ + k];
        hessian(models_ + k, m) += weighted;
        for (int n = 0; n <= m; ++n) {
          hessian(m, n) += weighted * centred_[n * classes_ + k];
        }
      }
      hessian(models_ + k, models_ + k) += p_[k];
      for (int l = 0; l <= k; ++l) {
        hessian(models_ + k, models_ + l) -= p_[k] * p_[l];
      }
    }
  }

  int models_;
  int classes_;
  std::vector<int> labels_;
  // [contacts][classes][models]
  std::vector<double> scores_;
  // Probabilities of the contact that is worked on, and the means of it.
  std::vector<double> p_;
  std::vector<double> mean_;
  std::vector<double> centred_;  // [models][classes]
};

// The Newton step of the free parameters; 0 for the others.
VectorXd FreeStep(const VectorXd& gradient, const MatrixXd& hessian,
                  const std::vector<int>& free) {
  const int n = static_cast<int>(free.size());
  VectorXd g(n);
  MatrixXd h(n, n);
  for (int i = 0; i < n; ++i) {
    g[i] = gradient[free[i]];
    for (int j = 0; j <= i; ++j) h(i, j) = hessian(free[i], free[j]);
    // Scores that are equal for all classes have no curvature.
    h(i, i) = h(i, i) * (1 + 1e-9) + 1e-12;
  }
  const VectorXd solved = h.ldlt().solve(-g);  // reads the lower triangle
  VectorXd step = VectorXd::Zero(gradient.size());
  for (int i = 0; i < n; ++i) step[free[i]] = solved[i];
  return step;
}

}  // namespace

SoftmaxFit FitSoftmax(std::span<const ScoredLabel> contacts,
                      std::span<const WeightBounds> bounds, int classes) {
  const int models = static_cast<int>(bounds.size());
  Problem problem(contacts, models, classes);
  const auto project = [&](VectorXd x) {
    for (int m = 0; m < models; ++m) {
      x[m] = std::clamp(x[m], bounds[m].min, bounds[m].max);
    }
    return x;
  };
  VectorXd x = VectorXd::Zero(problem.size());
  for (int m = 0; m < models; ++m) {
    // Geometric, because inverse temperatures span decades.
    x[m] = std::sqrt(std::max(bounds[m].min, 1e-4) * bounds[m].max);
  }
  VectorXd gradient;
  MatrixXd hessian;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const double loss = problem.Loss(x, gradient, hessian);
    std::vector<int> free;
    for (int i = 0; i < problem.size(); ++i) {
      const bool held =
          i < models && ((x[i] <= bounds[i].min && gradient[i] > 0) ||
                         (x[i] >= bounds[i].max && gradient[i] < 0));
      if (!held) free.push_back(i);
    }
    const VectorXd step = FreeStep(gradient, hessian, free);
    double fall = 0;
    double length = 1;
    for (int halving = 0; halving < kMaxHalvings; ++halving, length /= 2) {
      const VectorXd tried = project(x + length * step);
      fall = loss - problem.Loss(tried);
      if (fall > 0) {
        x = tried;
        break;
      }
    }
    if (!(fall > kConverged * loss)) break;
  }
  SoftmaxFit fit;
  fit.weights.assign(x.data(), x.data() + models);
  fit.bias.assign(x.data() + models, x.data() + x.size());
  return fit;
}

double LogLoss(const SoftmaxFit& fit, const ScoredLabel& contact) {
  const int models = static_cast<int>(fit.weights.size());
  const int classes = static_cast<int>(fit.bias.size());
  Problem problem({&contact, 1}, models, classes);
  VectorXd x(models + classes);
  std::ranges::copy(fit.weights, x.data());
  std::ranges::copy(fit.bias, x.data() + models);
  return problem.LossOf(0, x);
}

}  // namespace tactus::internal
