#include "core/train/model_fit.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/train/fit_fields.h"

namespace tactus::internal {
namespace {

// Work of the HMMs of a class relative to that of a network.
constexpr double kHmmWeight = 0.05;

VariationRange WithoutStiffness(VariationRange range) {
  range.stiffness = 1;
  return range;
}

bool TruthIsKnown(const std::vector<const LabelledContact*>& contacts) {
  return std::all_of(contacts.begin(), contacts.end(),
                     [](const LabelledContact* c) {
                       return c->stiffness > 0 && !c->object_motion.empty();
                     });
}

}  // namespace

ModelFit::ModelFit(const FitRun& run, std::string prefix,
                   const Networks& networks,
                   std::vector<const LabelledContact*> contacts)
    : run_(run),
      prefix_(std::move(prefix)),
      hmm_contacts_(contacts, WithoutStiffness(run.options.variations),
                    run.options.seed),
      lstm_contacts_(contacts, run.options.variations, run.options.seed),
      lstms_(networks.lstms),
      estimates_(networks.estimator && networks.lstms > 0 &&
                 run.options.lstm.estimates && TruthIsKnown(contacts)),
      networks_(lstms_ + (estimates_ ? 1 : 0)) {
  trained_.resize(networks_);
  model_.class_names = run.class_names;
  model_.questions = run.questions;
  model_.hmm_score = run.options.score;
  model_.truth = run.options.truth;
  model_.layout = contacts.front()->layout;
  if (run.options.learner == Learner::kHmms)
    model_.hmms.resize(run.class_names.size());
}

size_t ModelFit::InputBytes() const {
  if (networks_ == 0) return 0;
  const LstmFit& fit = run_.options.lstm;
  const size_t inputs =
      CuesFor(fit.cues, run_.options.features).size() +
      CuesFor(fit.stretched_cues, run_.options.features).size() *
          static_cast<size_t>(fit.stretches);
  return LstmInputs::KeptBytes(lstm_contacts_, inputs, fit.steps);
}

absl::Status ModelFit::FitHmmInputs(const ParallelFor& parallel) {
  if (run_.options.learner == Learner::kHmms)
    hmm_contacts_.MeasureNoise(parallel);
  TACTUS_ASSIGN_OR_RETURN(
      model_.inputs,
      tactus::internal::FitHmmInputs(run_, absl::StrCat(prefix_, "inputs"),
                                     hmm_contacts_, parallel, &hmm_cues_));
  return absl::OkStatus();
}

absl::Status ModelFit::FitLstmInputs(bool keep, bool put) {
  if (networks_ > 0) lstm_contacts_.MeasureNoise();
  TACTUS_RETURN_IF_ERROR(
      tactus::internal::FitLstmInputs(run_, absl::StrCat(prefix_, "inputs"),
                                      lstm_contacts_, put, &model_.inputs));
  if (networks_ > 0) {
    lstm_inputs_.emplace(lstm_contacts_, run_.class_names, model_.inputs,
                         LstmInputs::Options{.keep = keep,
                                             .with_targets = estimates_,
                                             .truth = run_.options.truth});
  }
  return absl::OkStatus();
}

int ModelFit::NetworkOf(int task) const {
  if (networks_ == 0) return -1;
  if (task == 0) return 0;
  return task <= FirstTasks() ? -1 : task - FirstTasks();
}

int ModelFit::ClassOf(int task) const {
  return networks_ == 0 ? task : task - 1;
}

int ModelFit::QuickestTask() const {
  if (run_.options.learner != Learner::kHmms) return networks_ == 0 ? 0 : 1;
  const auto contacts_of = [&](const std::string& name) {
    return std::ranges::count(hmm_contacts_.originals(), name,
                              &LabelledContact::label);
  };
  const auto smallest =
      std::ranges::min_element(run_.class_names, {}, contacts_of);
  const auto c = static_cast<int>(smallest - run_.class_names.begin());
  return networks_ == 0 ? c : c + 1;
}

double ModelFit::Weight(int task) const {
  return static_cast<double>(lstm_contacts_.size()) *
         (NetworkOf(task) >= 0 ? 1 : kHmmWeight);
}

std::string ModelFit::PartOf(int task) const {
  if (const int n = NetworkOf(task); n >= 0) {
    return n == lstms_ ? absl::StrCat(prefix_, "estimator")
                       : absl::StrCat(prefix_, "lstm/", n);
  }
  switch (run_.options.learner) {
    case Learner::kRidge:
      return absl::StrCat(prefix_, "ridge");
    case Learner::kTrees:
      return absl::StrCat(prefix_, "trees");
    case Learner::kNearest:
      return absl::StrCat(prefix_, "nearest");
    case Learner::kHmms:
      break;
  }
  return absl::StrCat(prefix_, "hmm/", run_.class_names[ClassOf(task)]);
}

absl::Status ModelFit::FitTask(int task, const Progress& progress,
                               const ParallelFor& parallel) {
  if (NetworkOf(task) >= 0) return FitNetwork(task, progress);
  const std::string part = PartOf(task);
  const auto& originals = hmm_contacts_.originals();
  switch (run_.options.learner) {
    case Learner::kRidge: {
      TACTUS_ASSIGN_OR_RETURN(model_.ridge,
                              FitContactRidge(run_, part, originals, progress));
      return absl::OkStatus();
    }
    case Learner::kTrees: {
      TACTUS_ASSIGN_OR_RETURN(model_.trees,
                              FitContactTrees(run_, part, originals, progress));
      return absl::OkStatus();
    }
    case Learner::kNearest: {
      TACTUS_ASSIGN_OR_RETURN(
          model_.nearest, FitContactNearest(run_, part, originals, progress));
      return absl::OkStatus();
    }
    case Learner::kHmms:
      break;
  }
  const int c = ClassOf(task);
  TACTUS_ASSIGN_OR_RETURN(model_.hmms[c],
                          FitClassHmms(run_, part, hmm_contacts_, model_.inputs,
                                       hmm_cues_, c, parallel, progress));
  return absl::OkStatus();
}

absl::Status ModelFit::FitNetwork(int task, const Progress& progress) {
  const int n = NetworkOf(task);
  const bool estimator = n == lstms_;
  TACTUS_ASSIGN_OR_RETURN(
      trained_[n],
      FitLstm(run_, PartOf(task), *lstm_inputs_, model_.inputs,
              estimator ? run_.options.lstm.networks : n, estimator, progress));
  return absl::OkStatus();
}

void ModelFit::GiveTask(int task, ByteWriter& writer) const {
  if (const int n = NetworkOf(task); n >= 0) return writer(trained_[n]);
  switch (run_.options.learner) {
    case Learner::kRidge:
      return writer(*model_.ridge);
    case Learner::kTrees:
      return writer(*model_.trees);
    case Learner::kNearest:
      return writer(*model_.nearest);
    case Learner::kHmms:
      return writer(model_.hmms[ClassOf(task)]);
  }
}

void ModelFit::TakeTask(int task, ByteReader& reader) {
  if (const int n = NetworkOf(task); n >= 0) return reader(trained_[n]);
  switch (run_.options.learner) {
    case Learner::kRidge:
      return reader(model_.ridge.emplace());
    case Learner::kTrees:
      return reader(model_.trees.emplace());
    case Learner::kNearest:
      return reader(model_.nearest.emplace());
    case Learner::kHmms:
      return reader(model_.hmms[ClassOf(task)]);
  }
}

Model ModelFit::TakeModel() {
  Calibration& c = model_.calibration;
  c.frames = {1};
  c.hmm_inverse_temperature = {1};
  c.evidence_median = {0};
  c.evidence_deviation = {1};
  const size_t classes = run_.class_names.size();
  c.prior.assign(classes, 1.0 / static_cast<double>(classes));
  c.hmm_bias.assign(classes, 0);
  if (networks_ > 0) {
    c.lstm_inverse_temperature = {1};
    c.hmm_weight = {0.5};
    c.lstm_weight = {0.5};
    c.lstm_bias = c.fused_bias = c.hmm_bias;
  }
  if (estimates_) {
    model_.estimator = std::move(trained_.back());
    trained_.pop_back();
  }
  model_.lstms = std::move(trained_);
  return std::move(model_);
}

}  // namespace tactus::internal
