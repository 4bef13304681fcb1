#include "client/bench/frontier_precision.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "absl/strings/str_format.h"
#include "client/bench/frontier_classifier.h"
#include "client/bench/hmm_models.h"
#include "client/bench/sim_check.h"
#include "client/stream/percentile.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/eval/fit.h"
#include "core/eval/inputs.h"
#include "core/hmm/forward.h"
#include "core/hmm/hmm_bank.h"
#include "core/hmm/scaled_filter.h"

namespace tactus::client {
namespace {

constexpr int kContacts = 100;
constexpr int kQuickContacts = 4;
constexpr int kRounds = 15;

// log sum_k exp(values_k).
template <typename T>
T LogSumExp(std::span<const T> values) {
  const T largest = *std::ranges::max_element(values);
  T sum = 0;
  for (const T value : values) sum += std::exp(value - largest);
  return largest + std::log(sum);
}

// A way to score all categories frame by frame.
class Rung {
 public:
  virtual ~Rung() = default;
  virtual void Reset() = 0;
  virtual void Step(std::span<const double> observation) = 0;
  // One per category.
  virtual void Scores(std::span<double> out) = 0;
};

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
  static absl::StatusOr<std::unique_ptr<Rung>> Create(
      const std::vector<HmmMixture>& mixtures) {
    auto rung = std::unique_ptr<LogarithmRung>(new LogarithmRung(mixtures));
    for (const GaussianHmm* model : rung->models()) {
      TACTUS_ASSIGN_OR_RETURN(CompiledHmm compiled,
                              CompiledHmm::Create(*model));
      rung->hmms_.push_back(std::make_unique<CompiledHmm>(std::move(compiled)));
      rung->filters_.emplace_back(*rung->hmms_.back());
    }
    return rung;
  }

  void Reset() override {
    for (ForwardFilter& filter : filters_) filter.Reset();
  }
  void Step(std::span<const double> x) override {
    for (ForwardFilter& filter : filters_) filter.Step(x);
  }

 private:
  using ComponentRung::ComponentRung;

  void ReadComponents(std::span<double> scores) override {
    for (size_t k = 0; k < filters_.size(); ++k) {
      scores[k] = filters_[k].log_likelihood();
    }
  }

  std::vector<std::unique_ptr<CompiledHmm>> hmms_;
  std::vector<ForwardFilter> filters_;
};

// What the HMMs see of a contact until kFrontierSeconds after onset, and what
// is true of it.
struct Sequence {
  std::vector<double> observations;
  int label = 0;
  std::vector<long double> truth;  // one per category
};

std::vector<Sequence> MakeSequences(const Model& model,
                                    const std::vector<Contact>& contacts,
                                    int count) {
  std::vector<Sequence> sequences;
  for (int i = 0; i < count; ++i) {
    Contact contact = contacts[i];
    const auto frames =
        static_cast<size_t>(kFrontierSeconds * contact.sample_rate_hz);
    contact.frames.resize(std::min(frames, contact.frames.size()));
    Sequence sequence;
    sequence.observations =
        MakeSequence(contact, model.features.hmm, model.features.hmm_steps);
    sequence.label =
        static_cast<int>(std::ranges::find(model.class_names, contact.label) -
                         model.class_names.begin());
    for (const HmmMixture& mixture : model.hmms) {
      std::vector<long double> scores;
      for (size_t k = 0; k < mixture.components.size(); ++k) {
        scores.push_back(mixture.log_weight[k] +
                         ReferenceScore(mixture.components[k], Score::kForward,
                                        sequence.observations));
      }
      sequence.truth.push_back(LogSumExp(std::span<const long double>(scores)));
    }
    sequences.push_back(std::move(sequence));
  }
  return sequences;
}

void ScoreSequence(const Sequence& sequence, size_t dimensions, Rung& rung,
                   std::vector<double>& scores) {
  rung.Reset();
  const std::span<const double> all(sequence.observations);
  for (size_t t = 0; t < all.size(); t += dimensions) {
    rung.Step(all.subspan(t, dimensions));
    rung.Scores(scores);
  }
}

struct NamedRung {
  const char* family;
  const char* name;
  // Largest error of a right answer, relative to the log-likelihood.
  double tolerance;
  std::unique_ptr<Rung> rung;
};

// Error and accuracy; NUMERICAL_FAILURE beyond the tolerance.
absl::StatusOr<FrontierPoint> Check(const NamedRung& named,
                                    const std::vector<Sequence>& sequences,
                                    size_t dimensions) {
  double worst = 0;
  int right = 0;
  for (const Sequence& sequence : sequences) {
    std::vector<double> scores(sequence.truth.size());
    ScoreSequence(sequence, dimensions, *named.rung, scores);
    const double steps = static_cast<double>(sequence.observations.size()) /
                         static_cast<double>(dimensions);
    for (size_t c = 0; c < scores.size(); ++c) {
      const auto off =
          static_cast<double>(std::abs(scores[c] - sequence.truth[c]));
      const auto scale =
          static_cast<double>(std::abs(sequence.truth[c])) + steps;
      if (!(off <= named.tolerance * scale)) {
        return NumericalFailure(absl::StrFormat(
            "%s, %s: a log-likelihood is off by %g of %g; %g of it would be "
            "right",
            named.family, named.name, off, scale, named.tolerance));
      }
      worst = std::max(worst, off / steps);
    }
    right +=
        std::ranges::max_element(scores) - scores.begin() == sequence.label;
  }
  return FrontierPoint{
      .ladder = Ladder::kPrecision,
      .family = named.family,
      .variant = named.name,
      .error = worst,
      .error_reference = "logarithms in long double, nats per scored frame",
      .accuracy =
          static_cast<double>(right) / static_cast<double>(sequences.size())};
}

}  // namespace

absl::StatusOr<std::vector<FrontierPoint>> MeasurePrecision(
    const Model& model, const std::vector<Contact>& contacts, bool quick) {
  const std::vector<Sequence> sequences =
      MakeSequences(model, contacts, quick ? kQuickContacts : kContacts);
  const size_t dimensions = model.features.hmm.size();
  TACTUS_ASSIGN_OR_RETURN(HmmBank bank, HmmBank::Create(model.hmms));
  TACTUS_ASSIGN_OR_RETURN(auto logarithms, LogarithmRung::Create(model.hmms));
  std::vector<NamedRung> rungs;
  rungs.push_back({"scaled", "float as served", 1e-6,
                   std::make_unique<BankRung>(std::move(bank))});
  rungs.push_back(
      {"scaled", "double", 1e-12, std::make_unique<DoubleRung>(model.hmms)});
  rungs.push_back({"logarithms", "double", 1e-12, std::move(logarithms)});

  std::vector<FrontierPoint> points;
  for (const NamedRung& named : rungs) {
    TACTUS_ASSIGN_OR_RETURN(points.emplace_back(),
                            Check(named, sequences, dimensions));
  }
  size_t steps = 0;
  for (const Sequence& sequence : sequences) {
    steps += sequence.observations.size() / dimensions;
  }
  std::vector<double> scores(model.hmms.size());
  std::vector<std::vector<double>> seconds(rungs.size());
  for (int round = 0; round < (quick ? 2 : kRounds); ++round) {
    for (size_t r = 0; r < rungs.size(); ++r) {
      const double start = ThreadSeconds();
      for (const Sequence& sequence : sequences) {
        ScoreSequence(sequence, dimensions, *rungs[r].rung, scores);
      }
      seconds[r].push_back(ThreadSeconds() - start);
    }
  }
  for (size_t r = 0; r < rungs.size(); ++r) {
    points[r].nanoseconds =
        Percentile(seconds[r], 0.5) / static_cast<double>(steps) * 1e9;
  }
  return points;
}

}  // namespace tactus::client
