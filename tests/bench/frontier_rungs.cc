#include "tests/bench/frontier_rungs.h"

#include <map>
#include <utility>

#include "core/base/status_macros.h"
#include "core/hmm/hmm_bank.h"
#include "core/hmm/scaled_filter.h"
#include "tests/reference/hmm/forward_filter.h"

namespace tactus::client {
namespace {

class BankRung : public Rung {
 public:
  explicit BankRung(HmmBank bank)
      : bank_(std::move(bank)), filter_(bank_, Score::kForward) {}

  void Reset() override { filter_.Reset(); }
  void Step(std::span<const double> x) override { filter_.Step(x); }
  void Scores(std::span<double> out) override { filter_.LogLikelihood(out); }

 private:
  HmmBank bank_;
  BankFilter filter_;
};

// Log-likelihoods of all components in turn, put together by category.
class ComponentRung : public Rung {
 public:
  explicit ComponentRung(const std::vector<HmmMixture>& mixtures)
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

class DoubleRung : public ComponentRung {
 public:
  explicit DoubleRung(const std::vector<HmmMixture>& mixtures)
      : ComponentRung(mixtures) {
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

class LogarithmRung : public ComponentRung {
 public:
  LogarithmRung(const std::vector<HmmMixture>& mixtures,
                std::vector<CompiledHmm> hmms)
      : ComponentRung(mixtures), hmms_(std::move(hmms)) {
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

}  // namespace

absl::StatusOr<std::unique_ptr<Rung>> MakeServedRung(
    const std::vector<HmmMixture>& mixtures) {
  TACTUS_ASSIGN_OR_RETURN(HmmBank bank, HmmBank::Create(mixtures));
  return std::make_unique<BankRung>(std::move(bank));
}

std::unique_ptr<Rung> MakeDoubleRung(const std::vector<HmmMixture>& mixtures) {
  return std::make_unique<DoubleRung>(mixtures);
}

absl::StatusOr<std::unique_ptr<Rung>> MakeLogarithmRung(
    const std::vector<HmmMixture>& mixtures) {
  std::vector<CompiledHmm> hmms;
  for (const HmmMixture& mixture : mixtures) {
    for (const GaussianHmm& model : mixture.components) {
      TACTUS_ASSIGN_OR_RETURN(CompiledHmm hmm, CompiledHmm::Create(model));
      hmms.push_back(std::move(hmm));
    }
  }
  return std::make_unique<LogarithmRung>(mixtures, std::move(hmms));
}

}  // namespace tactus::client
