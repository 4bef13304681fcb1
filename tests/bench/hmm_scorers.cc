#include "tests/bench/hmm_scorers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "Eigen/Cholesky"
#include "Eigen/Core"
#include "core/base/status_macros.h"
#include "core/hmm/hmm_bank.h"
#include "core/hmm/scaled_filter.h"
#include "tests/reference/hmm/forward_filter.h"

namespace tactus::internal::client {
namespace {

class BankScorer : public HmmScorer {
 public:
  explicit BankScorer(HmmBank bank)
      : bank_(std::move(bank)), filter_(bank_, Score::kForward) {}

  void Reset() override { filter_.Reset(); }
  void Step(std::span<const double> x) override { filter_.Step(x); }
  void Scores(std::span<double> out) override { filter_.LogLikelihood(out); }

 private:
  HmmBank bank_;
  BankFilter filter_;
};

// Scores each component alone and adds up the components of each class.
class ComponentScorer : public HmmScorer {
 public:
  explicit ComponentScorer(const std::vector<HmmMixture>& mixtures)
      : mixtures_(&mixtures) {
    for (const HmmMixture& mixture : mixtures) {
      for (const GaussianHmm& model : mixture.components) {
        models_.push_back(&model);
      }
    }
    scores_.resize(models_.size());
  }

  void Scores(std::span<double> out) override {
    ReadComponents(scores_);
    double* score = scores_.data();
    for (size_t c = 0; c < mixtures_->size(); ++c) {
      const std::vector<double>& weight = (*mixtures_)[c].log_weight;
      for (size_t k = 0; k < weight.size(); ++k) score[k] += weight[k];
      out[c] = LogSumExp(std::span<const double>(score, weight.size()));
      score += weight.size();
    }
  }

 protected:
  virtual void ReadComponents(std::span<double> scores) = 0;
  const std::vector<const GaussianHmm*>& models() const { return models_; }

 private:
  const std::vector<HmmMixture>* mixtures_;
  std::vector<const GaussianHmm*> models_;
  std::vector<double> scores_;
};

class DoubleScorer : public ComponentScorer {
 public:
  explicit DoubleScorer(const std::vector<HmmMixture>& mixtures)
      : ComponentScorer(mixtures) {
    std::map<HmmShape, std::vector<int>> shapes;
    for (size_t k = 0; k < models().size(); ++k) {
      shapes[ShapeOf(*models()[k])].push_back(static_cast<int>(k));
    }
    for (const auto& [shape, components] : shapes) {
      std::vector<const GaussianHmm*> alike;
      for (const int k : components) alike.push_back(models()[k]);
      groups_.push_back(std::make_unique<Group>(alike, components));
    }
  }

  void Reset() override {
    for (const auto& group : groups_) group->filter.Reset();
  }
  void Step(std::span<const double> x) override {
    for (const auto& group : groups_) group->filter.Step(x);
  }

 private:
  struct Group {
    Group(const std::vector<const GaussianHmm*>& alike, std::vector<int> places)
        : model(alike, UnitScale(alike[0]->dimensions)),
          filter(model, {}, Score::kForward),
          components(std::move(places)) {}

    ScaledModel<double> model;
    ScaledFilter<double> filter;
    std::vector<int> components;
  };

  void ReadComponents(std::span<double> scores) override {
    for (const auto& group : groups_) {
      group->filter.UpdateTotals();
      for (size_t k = 0; k < group->components.size(); ++k) {
        scores[group->components[k]] =
            group->filter.log_likelihood(static_cast<int>(k));
      }
    }
  }

  std::vector<std::unique_ptr<Group>> groups_;
};

class LogarithmScorer : public ComponentScorer {
 public:
  LogarithmScorer(const std::vector<HmmMixture>& mixtures,
                  std::vector<CompiledHmm> hmms)
      : ComponentScorer(mixtures), hmms_(std::move(hmms)) {
    for (const CompiledHmm& hmm : hmms_) filters_.emplace_back(hmm);
  }

  void Reset() override {
    for (ForwardFilter& filter : filters_) filter.Reset();
  }
  void Step(std::span<const double> x) override {
    for (ForwardFilter& filter : filters_) filter.Step(x);
  }

 private:
  void ReadComponents(std::span<double> scores) override {
    for (size_t k = 0; k < filters_.size(); ++k) {
      scores[k] = filters_[k].log_likelihood();
    }
  }

  std::vector<CompiledHmm> hmms_;
  std::vector<ForwardFilter> filters_;
};

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
  // Values of this frame; 0 for a state that is not reached.
  double predicted = 0;
  double log_density = 0;
  double mass = 0;  // fraction of the class's forward mass
};

// All components of a class as one HMM.
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
      state->mass = state->predicted * std::exp(state->log_density - highest);
      mass += state->mass;
    }
    log_likelihood_ += highest + std::log(mass);
    active_.clear();
    for (State* state : reached_) {
      state->predicted = 0;
      state->mass /= mass;
      if (state->mass > bound_) active_.push_back(state);
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
        reach(states_[to], state->mass * probability);
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

class PrunedScorer : public HmmScorer {
 public:
  PrunedScorer(const std::vector<HmmMixture>& mixtures, double bound) {
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

absl::StatusOr<std::unique_ptr<HmmScorer>> MakeServedScorer(
    const std::vector<HmmMixture>& mixtures) {
  TACTUS_ASSIGN_OR_RETURN(HmmBank bank, HmmBank::Create(mixtures));
  return std::make_unique<BankScorer>(std::move(bank));
}

std::unique_ptr<HmmScorer> MakeDoubleScorer(
    const std::vector<HmmMixture>& mixtures) {
  return std::make_unique<DoubleScorer>(mixtures);
}

absl::StatusOr<std::unique_ptr<HmmScorer>> MakeLogarithmScorer(
    const std::vector<HmmMixture>& mixtures) {
  std::vector<CompiledHmm> hmms;
  for (const HmmMixture& mixture : mixtures) {
    for (const GaussianHmm& model : mixture.components) {
      TACTUS_ASSIGN_OR_RETURN(CompiledHmm hmm, CompiledHmm::Create(model));
      hmms.push_back(std::move(hmm));
    }
  }
  return std::make_unique<LogarithmScorer>(mixtures, std::move(hmms));
}

std::unique_ptr<HmmScorer> MakePrunedScorer(
    const std::vector<HmmMixture>& mixtures, double bound) {
  return std::make_unique<PrunedScorer>(mixtures, bound);
}

}  // namespace tactus::internal::client
