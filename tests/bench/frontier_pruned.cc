#include "tests/bench/frontier_pruned.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "Eigen/Cholesky"
#include "Eigen/Core"

namespace tactus::client {
namespace {

struct State {
  State(const GaussianHmm& model, int state)
      : mean(Eigen::Map<const Eigen::MatrixXd>(model.means.data(),
                                               model.dimensions, model.states)
                 .col(state)) {
    const int d = model.dimensions;
    Eigen::MatrixXd covariance(d, d);
    FullCovariance(model, state, covariance.data());
    whitening =
        covariance.llt().matrixL().solve(Eigen::MatrixXd::Identity(d, d));
    log_constant = whitening.diagonal().array().log().sum() -
                   0.5 * d * std::log(2 * std::numbers::pi);
  }

  Eigen::VectorXd mean;
  Eigen::MatrixXd whitening;  // inverse Cholesky factor
  double log_constant;
  double start = 0;                               // with the component's weight
  std::vector<std::pair<int, double>> next = {};  // states it leads to
  // Of this frame; 0 of a state that is not reached.
  double predicted = 0;
  double log_density = 0;
  double share = 0;  // of the category's forward mass
};

// All components of a category as one HMM.
class PrunedCategory {
 public:
  PrunedCategory(const HmmMixture& mixture, double bound) : bound_(bound) {
    for (size_t k = 0; k < mixture.components.size(); ++k) {
      const GaussianHmm& model = mixture.components[k];
      const int first = static_cast<int>(states_.size());
      const double* transition = model.transition.data();
      for (int i = 0; i < model.states; ++i) {
        State& state = states_.emplace_back(model, i);
        state.start = std::exp(mixture.log_weight[k]) * model.start[i];
        for (int j = 0; j < model.states; ++j, ++transition) {
          if (*transition > 0) state.next.push_back({first + j, *transition});
        }
      }
    }
    difference_.resize(mixture.components[0].dimensions);
    whitened_.resize(mixture.components[0].dimensions);
  }

  void Reset() {
    log_likelihood_ = 0;
    active_.clear();
  }

  void Step(std::span<const double> x) {
    Predict();
    double highest = -std::numeric_limits<double>::infinity();
    for (State* state : reached_) {
      difference_ =
          Eigen::Map<const Eigen::VectorXd>(x.data(), difference_.size()) -
          state->mean;
      whitened_.noalias() = state->whitening * difference_;
      state->log_density = state->log_constant - 0.5 * whitened_.squaredNorm();
      highest = std::max(highest, state->log_density);
    }
    double mass = 0;
    for (State* state : reached_) {
      state->share = state->predicted * std::exp(state->log_density - highest);
      mass += state->share;
    }
    log_likelihood_ += highest + std::log(mass);
    active_.clear();
    for (State* state : reached_) {
      state->predicted = 0;
      state->share /= mass;
      if (state->share > bound_) active_.push_back(state);
    }
  }

  double log_likelihood() const { return log_likelihood_; }

 private:
  void Predict() {
    reached_.clear();
    const auto reach = [this](State& state, double probability) {
      if (state.predicted == 0 && probability > 0) reached_.push_back(&state);
      state.predicted += probability;
    };
    if (active_.empty()) {
      for (State& state : states_) reach(state, state.start);
    }
    for (const State* state : active_) {
      for (const auto& [to, probability] : state->next) {
        reach(states_[to], state->share * probability);
      }
    }
  }

  double bound_;
  std::vector<State> states_;
  std::vector<State*> active_;
  std::vector<State*> reached_;
  double log_likelihood_ = 0;
  Eigen::VectorXd difference_;
  Eigen::VectorXd whitened_;
};

class PrunedRung : public Rung {
 public:
  PrunedRung(const std::vector<HmmMixture>& mixtures, double bound) {
    for (const HmmMixture& mixture : mixtures) {
      categories_.emplace_back(mixture, bound);
    }
  }

  void Reset() override {
    for (PrunedCategory& category : categories_) category.Reset();
  }
  void Step(std::span<const double> x) override {
    for (PrunedCategory& category : categories_) category.Step(x);
  }
  void Scores(std::span<double> out) override {
    std::ranges::transform(categories_, out.begin(),
                           &PrunedCategory::log_likelihood);
  }

 private:
  std::vector<PrunedCategory> categories_;
};

}  // namespace

std::unique_ptr<Rung> MakePrunedRung(const std::vector<HmmMixture>& mixtures,
                                     double bound) {
  return std::make_unique<PrunedRung>(mixtures, bound);
}

}  // namespace tactus::client
