// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/status_macros.h"
#include "core/eval/evaluate.h"
#include "core/eval/evaluate_nearest.h"
#include "core/eval/evaluation.h"
#include "core/eval/metrics.h"
#include "core/eval/paper_tables.h"
#include "core/eval/unknown.h"
#include "core/train/anytime.h"
#include "core/train/calibrate.h"
#include "core/train/fit.h"
#include "core/train/fit_models.h"
#include "core/train/fit_options.h"
#include "core/train/folds.h"
#include "core/train/inputs.h"
#include "core/train/labelled_contact.h"
#include "core/train/variation.h"
#include "core/train/work.h"

namespace tactus::examples {

std::map<absl::string_view, double> done;

using Contacts = std::vector<const LabelledContact*>;

void EvaluateExample(const Contacts& contacts, const FitOptions& options) {
  auto result = EvaluateProtocol(contacts, Protocol::kLeaveOneConditionOut,
                                 Algorithm::kFused, options, RunSerially);
  Accuracy(result->final);
}

absl::Status EvaluateNearestExample(const Contacts& contacts,
                                    const std::vector<std::vector<int>>& folds,
                                    size_t f,
                                    const std::vector<Feature>& features,
                                    Evaluation& result) {
  TACTUS_RETURN_IF_ERROR(
      EvaluateNearestFold(contacts, folds[f], features, result));
  return absl::OkStatus();
}

absl::Status EvaluationExample(
    const std::shared_ptr<const CompiledModel>& model,
    const Contacts& contacts) {
  TACTUS_ASSIGN_OR_RETURN(
      Evaluation result,
      EvaluateModel(model, contacts, Algorithm::kFused, RunSerially));
  AlgorithmName(result.algorithm);  // "hmm" if the model has no LSTMs
  Accuracy(result.final);
  return absl::OkStatus();
}

void MetricsExample(const std::vector<Outcome>& outcomes) {
  const int right = CountRight(outcomes);
  const Interval interval = WilsonInterval(right, outcomes.size());
}

void PaperTablesExample() {
  for (const PaperRow& row : PaperTable(Experiment::kSimulation)) {
    row.accuracy_percent;  // 82.13 for HMM, f + m
  }
}

absl::Status UnknownExample(const Contacts& contacts,
                            const FitOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(auto result,
                          EvaluateUnknown(contacts, options, RunSerially));
  result[0].area_under_roc;
  return absl::OkStatus();
}

absl::Status LabelledContactExample(const Trial& trial) {
  int undetectable = 0;
  TACTUS_ASSIGN_OR_RETURN(auto contact, ExtractContact(trial));
  if (!contact.has_value()) ++undetectable;
  return absl::OkStatus();
}

absl::Status FitExample(const Contacts& contacts) {
  TACTUS_ASSIGN_OR_RETURN(FitOptions options, FitPreset("tuned"));
  TACTUS_ASSIGN_OR_RETURN(Model model,
                          FitModel(contacts, options, RunSerially));
  return absl::OkStatus();
}

void AnytimeExample(const std::shared_ptr<const CompiledModel>& model,
                    const LabelledContact& contact, int label,
                    std::map<double, double>& accuracy) {
  ContactClassifier classifier(model, {});
  WalkContact(contact, classifier, [&](int time) {
    accuracy[kAnytimeSeconds[time]] = classifier.probability()[label];
  });
}

void CalibrateExample(
    const std::shared_ptr<const CompiledModel>& model_without_it,
    const LabelledContact& contact, int label, Model& model) {
  std::vector<ScoredContact> scored;
  scored.push_back(ScoreContact(model_without_it, contact, label));
  FitCalibration(scored, /*rate=*/100, model.calibration);
}

absl::Status FoldsExample(const Contacts& contacts) {
  TACTUS_ASSIGN_OR_RETURN(auto folds,
                          MakeFolds(contacts, Protocol::kLeaveOneConditionOut));
  for (const std::vector<int>& fold : folds) {
    std::vector<int> training = Complement(fold, contacts.size());
  }
  return absl::OkStatus();
}

void WorkExample(const Contacts& contacts, const FitOptions& options) {
  Progress progress([](absl::string_view phase, double fraction) {
    done[phase] += fraction;  // 1 in the end
  });
  FitModel(contacts, options, RunSerially, progress);
}

absl::Status FitModelsExample(const Contacts& contacts,
                              const std::vector<std::string>& names,
                              const FitOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(Model model,
                          FitHmms(contacts, names, options, Progress()));
  TACTUS_RETURN_IF_ERROR(FitLstms(contacts, options, /*networks=*/3,
                                  RunSerially, Progress(), model));
  return absl::OkStatus();
}

absl::Status FitOptionsExample(const Contacts& contacts) {
  TACTUS_ASSIGN_OR_RETURN(FitOptions options, FitPreset("tuned"));
  options.lstm.networks = 1;
  TACTUS_ASSIGN_OR_RETURN(Model model,
                          FitModel(contacts, options, RunSerially));
  return absl::OkStatus();
}

void InputsExample(const Contacts& contacts, const LabelledContact& contact,
                   const std::vector<Cue>& cues, const StepIntervals& steps) {
  auto inputs = FitInputs(contacts, cues, {});
  std::vector<double> rows = MakeSequence(contact, inputs, steps);
}

void VariationExample(const LabelledContact& contact, uint64_t seed) {
  Random random(seed);
  LabelledContact other = Vary(contact, {.pace = 1.4, .load = 0.5}, random);
}

}  // namespace tactus::examples
