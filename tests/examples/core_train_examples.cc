// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/status_macros.h"
#include "core/base/work.h"
#include "core/contacts/anytime.h"
#include "core/contacts/choice_folds.h"
#include "core/contacts/class_counts.h"
#include "core/contacts/contact_frames.h"
#include "core/contacts/contact_set.h"
#include "core/contacts/copies.h"
#include "core/contacts/folds.h"
#include "core/contacts/labelled_contact.h"
#include "core/contacts/question_truth.h"
#include "core/contacts/touch_contacts.h"
#include "core/contacts/trained_on.h"
#include "core/contacts/variation.h"
#include "core/contacts/varied_contacts.h"
#include "core/contacts/world_contacts.h"
#include "core/eval/auto_preset.h"
#include "core/eval/baselines.h"
#include "core/eval/choice_proto.h"
#include "core/eval/chosen_options.h"
#include "core/eval/evaluate.h"
#include "core/eval/evaluate_nearest.h"
#include "core/eval/evaluation.h"
#include "core/eval/learning_curve.h"
#include "core/eval/metrics.h"
#include "core/eval/out_of_fold.h"
#include "core/eval/paper_tables.h"
#include "core/eval/question_outcome.h"
#include "core/eval/reliability.h"
#include "core/eval/unknown.h"
#include "core/inputs/cue_table.h"
#include "core/inputs/fit_embedding.h"
#include "core/inputs/inputs.h"
#include "core/inputs/lstm_inputs.h"
#include "core/train/archive.h"
#include "core/train/calibrate.h"
#include "core/train/choose_cues.h"
#include "core/train/fit.h"
#include "core/train/fit_decisions.h"
#include "core/train/fit_fields.h"
#include "core/train/fit_journal.h"
#include "core/train/fit_models.h"
#include "core/train/fit_options.h"
#include "core/train/fit_run.h"
#include "core/train/fit_unknown.h"
#include "core/train/lstm_work.h"
#include "core/train/measure_skin_range.h"
#include "core/train/model_fit.h"
#include "core/train/saved_parts.h"
#include "core/train/softmax_fit.h"
#include "core/train/usable.h"

namespace tactus::internal::examples {

std::map<absl::string_view, double> done;

using Contacts = std::vector<const LabelledContact*>;

void Remark(const std::string& text);

static void CopiesExample(const Contacts& contacts) {
#include "core/contacts/copies.h.inc"
}

struct Loaded {
  std::string data_sha256;
};

static void TrainedOnExample(const Contacts& contacts, Model model,
                             const Loaded& loaded) {
#include "core/contacts/trained_on.h.inc"
}

static absl::Status ContactSetExample(const LabelledContact& first,
                                      const LabelledContact& contact,
                                      const Model& model) {
#include "core/contacts/contact_set.h.inc"
  return absl::OkStatus();
}

static absl::Status AutoPresetExample(const Contacts& contacts,
                                      const FitOptions& tuned,
                                      const FitOptions& profile) {
#include "core/eval/auto_preset.h.inc"
  return absl::OkStatus();
}

static void ChoiceProtoExample(const PresetChoice& choice,
                               v1::OperationResult& result) {
#include "core/eval/choice_proto.h.inc"
}

static absl::Status LearningCurveExample(const Contacts& contacts,
                                         const Protocol& protocol,
                                         const FitOptions& options) {
#include "core/eval/learning_curve.h.inc"
  return absl::OkStatus();
}

static void MeasureSkinRangeExample(const Contacts& contacts, Model& model) {
#include "core/train/measure_skin_range.h.inc"
}

static void ChoiceFoldsExample(const Contacts& contacts) {
#include "core/contacts/choice_folds.h.inc"
}

static absl::Status OutOfFoldExample(const Contacts& contacts,
                                     const std::vector<std::vector<int>>& folds,
                                     const FitOptions& options) {
#include "core/eval/out_of_fold.h.inc"
  return absl::OkStatus();
}

static void LstmWorkExample(const Contacts& contacts,
                            const FitOptions& options) {
#include "core/train/lstm_work.h.inc"
}

static absl::Status ClassCountsExample(const Contacts& contacts,
                                       Protocol protocol) {
#include "core/contacts/class_counts.h.inc"
  return absl::OkStatus();
}

static absl::Status ChosenOptionsExample(const Contacts& contacts) {
#include "core/eval/chosen_options.h.inc"
  return absl::OkStatus();
}

static absl::Status BaselinesExample(const Contacts& contacts) {
#include "core/eval/baselines.h.inc"
  return absl::OkStatus();
}

static void EvaluateExample(const Contacts& contacts,
                            const FitOptions& options) {
#include "core/eval/evaluate.h.inc"
}

static absl::Status EvaluateNearestExample(
    const Contacts& contacts, const std::vector<std::vector<int>>& folds,
    size_t f, const std::vector<Feature>& features, Evaluation& result) {
#include "core/eval/evaluate_nearest.h.inc"
  return absl::OkStatus();
}

static absl::Status EvaluationExample(
    const std::shared_ptr<const CompiledModel>& model,
    const Contacts& contacts) {
#include "core/eval/evaluation.h.inc"
  return absl::OkStatus();
}

static void MetricsExample(const std::vector<Outcome>& outcomes) {
#include "core/eval/metrics.h.inc"
}

static void ReliabilityExample(
    const Evaluation& evaluation,
    const std::function<void(double, const Interval&)>& draw) {
#include "core/eval/reliability.h.inc"
}

static void PaperTablesExample() {
#include "core/eval/paper_tables.h.inc"
}

static absl::Status UnknownExample(const Contacts& contacts,
                                   const FitOptions& options) {
#include "core/eval/unknown.h.inc"
  return absl::OkStatus();
}

static absl::Status LabelledContactExample(const Trial& trial) {
  int never_felt = 0;
#include "core/contacts/labelled_contact.h.inc"
  return absl::OkStatus();
}

static absl::Status TouchContactsExample(const Trial& trial) {
#include "core/contacts/touch_contacts.h.inc"
  return absl::OkStatus();
}

static absl::Status FitEmbeddingExample(
    const Contacts& contacts, const std::vector<std::string>& class_names,
    InputSpec& spec) {
#include "core/inputs/fit_embedding.h.inc"
  return absl::OkStatus();
}

static absl::Status FitExample(const Contacts& contacts) {
#include "core/train/fit.h.inc"
  return absl::OkStatus();
}

static void AnytimeExample(const std::shared_ptr<const CompiledModel>& model,
                           const LabelledContact& contact, int label,
                           std::map<double, double>& accuracy) {
#include "core/contacts/anytime.h.inc"
}

static void CalibrateExample(
    const std::shared_ptr<const CompiledModel>& model_without_it,
    const LabelledContact& contact, Model& model) {
#include "core/train/calibrate.h.inc"
}

static void FitUnknownExample(std::span<const ScoredContact> scored,
                              Model& model) {
#include "core/train/fit_unknown.h.inc"
}

static void SoftmaxFitExample(std::span<const ScoredLabel> contacts,
                              std::span<const WeightBounds> bounds,
                              int classes) {
#include "core/train/softmax_fit.h.inc"
}

static absl::Status WorldContactsExample() {
#include "core/contacts/world_contacts.h.inc"
  return absl::OkStatus();
}

static absl::Status FoldsExample(const Contacts& contacts) {
#include "core/contacts/folds.h.inc"
  return absl::OkStatus();
}

static void WorkExample(const Contacts& contacts, const FitOptions& options) {
#include "core/base/work.h.inc"
}

static absl::Status FitModelsExample(const FitRun& run, const std::string& name,
                                     const VariedContacts& contacts,
                                     const InputSpec& spec,
                                     const CueTable& table, int c) {
#include "core/train/fit_models.h.inc"
  return absl::OkStatus();
}

static absl::Status ModelFitExample(const FitRun& run, const Contacts& contacts,
                                    const ParallelFor& RunOnThreads) {
#include "core/train/model_fit.h.inc"
  return absl::OkStatus();
}

static absl::Status FitRunExample(const FitRun& run) {
#include "core/train/fit_run.h.inc"
  return absl::OkStatus();
}

std::optional<std::string> Read(absl::string_view part);
absl::Status Write(absl::string_view part, const std::string& bytes);

static void FitJournalExample(const Contacts& contacts,
                              const FitOptions& options,
                              const ParallelFor& RunOnThreads,
                              const Progress& progress) {
#include "core/train/fit_journal.h.inc"
}

static absl::Status ArchiveExample(LstmCheckpoint checkpoint,
                                   absl::string_view part) {
#include "core/train/archive.h.inc"
  return absl::OkStatus();
}

static void FitFieldsExample(const FitOptions& options) {
  const auto model = std::make_unique<InputSpec>();
#include "core/train/fit_fields.h.inc"
}

static absl::Status SavedPartsExample(FitJournal* journal,
                                      const Contacts& contacts,
                                      const FitOptions& options) {
  const auto Train = [] { return HmmMixture(); };
#include "core/train/saved_parts.h.inc"
  return absl::OkStatus();
}

static void ContactFramesExample(const FeatureVector& signals) {
#include "core/contacts/contact_frames.h.inc"
}

static void LstmInputsExample(const VariedContacts& contacts,
                              const std::vector<std::string>& class_names,
                              const InputSpec& spec, LstmCheckpoint checkpoint,
                              const LstmTrainOptions& options) {
#include "core/inputs/lstm_inputs.h.inc"
}

static absl::Status UsableExample(Contacts contacts,
                                  const FitOptions& options) {
#include "core/train/usable.h.inc"
  return absl::OkStatus();
}

static void VariedContactsExample(const Contacts& contacts,
                                  const std::vector<ModelInput>& inputs,
                                  const StepIntervals& steps, uint64_t seed) {
#include "core/contacts/varied_contacts.h.inc"
}

static absl::Status ChooseCuesExample(FitOptions& options) {
#include "core/train/choose_cues.h.inc"
  return absl::OkStatus();
}

static absl::Status FitOptionsExample(const Contacts& contacts) {
#include "core/train/fit_options.h.inc"
  return absl::OkStatus();
}

static void InputsExample(const Contacts& contacts,
                          const LabelledContact& contact,
                          const std::vector<Cue>& cues,
                          const StepIntervals& steps) {
#include "core/inputs/inputs.h.inc"
}

static void CueTableExample(const VariedContacts& contacts,
                            const std::vector<Cue>& cues,
                            const ParallelFor& RunOnThreads) {
  struct Range {
    void Add(double) {}
  };
  std::vector<Range> ranges(cues.size());
  const auto Use = [](std::span<const double>) {};
#include "core/inputs/cue_table.h.inc"
}

static void VariationExample(const LabelledContact& contact, uint64_t seed) {
#include "core/contacts/variation.h.inc"
}

static void QuestionTruthExample(const Question& question, const Model& model,
                                 const LabelledContact& contact) {
#include "core/contacts/question_truth.h.inc"
}

static void QuestionOutcomeExample(
    const Question& question, const std::vector<std::string>& class_names,
    const LabelledContact& contact, ContactClassifier& classifier,
    QuestionOutcome& outcome, const std::vector<QuestionOutcome>& outcomes) {
#include "core/eval/question_outcome.h.inc"
}

static void FitDecisionsExample(
    const std::vector<const LabelledContact*>& held_out,
    std::shared_ptr<const CompiledModel> calibrated_model,
    Calibration& calibration) {
#include "core/train/fit_decisions.h.inc"
}

}  // namespace tactus::internal::examples
