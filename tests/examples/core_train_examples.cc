// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/status_macros.h"
#include "core/base/work.h"
#include "core/contacts/anytime.h"
#include "core/contacts/class_counts.h"
#include "core/contacts/contact_frames.h"
#include "core/contacts/contact_set.h"
#include "core/contacts/copies.h"
#include "core/contacts/folds.h"
#include "core/contacts/labelled_contact.h"
#include "core/contacts/trained_on.h"
#include "core/contacts/variation.h"
#include "core/contacts/varied_contacts.h"
#include "core/contacts/world_contacts.h"
#include "core/eval/auto_preset.h"
#include "core/eval/baselines.h"
#include "core/eval/choice_folds.h"
#include "core/eval/chosen_options.h"
#include "core/eval/evaluate.h"
#include "core/eval/evaluate_nearest.h"
#include "core/eval/evaluation.h"
#include "core/eval/metrics.h"
#include "core/eval/out_of_fold.h"
#include "core/eval/paper_tables.h"
#include "core/eval/unknown.h"
#include "core/inputs/cue_table.h"
#include "core/inputs/fit_embedding.h"
#include "core/inputs/inputs.h"
#include "core/inputs/lstm_inputs.h"
#include "core/train/archive.h"
#include "core/train/calibrate.h"
#include "core/train/choose_cues.h"
#include "core/train/fit.h"
#include "core/train/fit_fields.h"
#include "core/train/fit_journal.h"
#include "core/train/fit_models.h"
#include "core/train/fit_options.h"
#include "core/train/fit_run.h"
#include "core/train/fit_unknown.h"
#include "core/train/lstm_work.h"
#include "core/train/model_fit.h"
#include "core/train/saved_parts.h"
#include "core/train/softmax_fit.h"
#include "core/train/usable.h"

namespace tactus::examples {

std::map<absl::string_view, double> done;

using Contacts = std::vector<const LabelledContact*>;

void Remark(const std::string& text);

void CopiesExample(const Contacts& contacts) {
  for (const Copy& copy : FindCopies(contacts)) {
    Remark(CopyText(contacts, copy));
  }
}

struct Loaded {
  std::string data_sha256;
};

void TrainedOnExample(const Contacts& contacts, Model model,
                      const Loaded& loaded) {
  SetTrainedOn(contacts, model.provenance);
  const TrainedOn trained =
      FindTrainedOn(model.provenance, contacts, {.sha256 = loaded.data_sha256});
  if (trained.contacts > 0) std::cout << TrainedOnText(trained);
}

absl::Status ContactSetExample(const LabelledContact& first,
                               const LabelledContact& contact,
                               const Model& model) {
  TACTUS_RETURN_IF_ERROR(CheckOneSkin(first, contact));
  TACTUS_RETURN_IF_ERROR(CheckFits(contact, model));
  return absl::OkStatus();
}

absl::Status AutoPresetExample(const Contacts& contacts,
                               const FitOptions& tuned,
                               const FitOptions& profile) {
  TACTUS_ASSIGN_OR_RETURN(
      const PresetChoice choice,
      ChoosePreset(contacts,
                   {.presets = {{"tuned", tuned}, {"profile", profile}}},
                   RunSerially));
  FitModel(contacts, choice.options, RunSerially);
  return absl::OkStatus();
}

void ChoiceFoldsExample(const Contacts& contacts) {
  const ChoiceFolds folds = FoldsForChoice(contacts);
  folds.by;  // FoldsBy::kGroups
}

absl::Status OutOfFoldExample(const Contacts& contacts,
                              const std::vector<std::vector<int>>& folds,
                              const FitOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(
      const int right,
      CountOutOfFoldRight(contacts, folds, options, RunSerially));
  return absl::OkStatus();
}

void LstmWorkExample(const Contacts& contacts, const FitOptions& options) {
  LstmWork(contacts, options) / 1e9;  // billions of multiplications
}

absl::Status ClassCountsExample(const Contacts& contacts, Protocol protocol) {
  TACTUS_RETURN_IF_ERROR(CheckClasses(CountClasses(contacts), "contacts"));
  TACTUS_ASSIGN_OR_RETURN(auto folds, MakeFolds(contacts, protocol));
  TACTUS_RETURN_IF_ERROR(CheckFolds(contacts, folds, protocol));
  return absl::OkStatus();
}

absl::Status ChosenOptionsExample(const Contacts& contacts) {
  TACTUS_ASSIGN_OR_RETURN(
      const ChosenOptions chosen,
      ChooseOptions(contacts, {.preset = "auto", .options_of = FitPreset},
                    RunSerially));
  FitModel(chosen.contacts, chosen.options, RunSerially);
  return absl::OkStatus();
}

absl::Status BaselinesExample(const Contacts& contacts) {
  TACTUS_ASSIGN_OR_RETURN(auto folds,
                          MakeFolds(contacts, Protocol::kLeaveOneConditionOut));
  TACTUS_ASSIGN_OR_RETURN(const Baselines baselines,
                          MeasureBaselines(contacts, folds));
  baselines.nearest_right;  // of baselines.contacts
  return absl::OkStatus();
}

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

absl::Status FitEmbeddingExample(const Contacts& contacts,
                                 const std::vector<std::string>& class_names,
                                 InputSpec& spec) {
  TACTUS_ASSIGN_OR_RETURN(
      spec.embedding, FitTaxelEmbedding(contacts, class_names, spec.hmm_steps));
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
    const LabelledContact& contact, Model& model) {
  std::vector<ScoredContact> scored;
  scored.push_back(ScoreContact(model_without_it, contact));
  FitCalibration(scored, /*rate=*/100, model.calibration);
}

void FitUnknownExample(std::span<const ScoredContact> scored, Model& model) {
  FitUnknown(scored, model.calibration);
}

void SoftmaxFitExample(std::span<const ScoredLabel> contacts,
                       std::span<const WeightBounds> bounds, int classes) {
  const SoftmaxFit fit = FitSoftmax(contacts, bounds, classes);
  fit.weights[0];
}

absl::Status WorldContactsExample() {
  TACTUS_ASSIGN_OR_RETURN(
      const WorldRecipe recipe,
      ParseWorldRecipe("world:skin=good+measured,contacts=100000,seed=1"));
  TACTUS_ASSIGN_OR_RETURN(const WorldContacts world,
                          MakeWorldContacts(recipe, RunSerially));
  return absl::OkStatus();
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

absl::Status FitModelsExample(const FitRun& run, const std::string& name,
                              const VariedContacts& contacts,
                              const InputSpec& spec, const CueTable& table,
                              int c) {
  TACTUS_ASSIGN_OR_RETURN(HmmMixture mixture,
                          FitClassHmms(run, name, contacts, spec, table, c,
                                       RunSerially, Progress()));
  return absl::OkStatus();
}

absl::Status ModelFitExample(const FitRun& run, const Contacts& contacts,
                             const ParallelFor& RunOnThreads) {
  ModelFit fit(run, "fold/2/", {.lstms = 1}, contacts);
  TACTUS_RETURN_IF_ERROR(fit.FitHmmInputs(RunOnThreads));
  TACTUS_RETURN_IF_ERROR(fit.FitLstmInputs(/*keep=*/true));
  for (int task = 0; task < fit.tasks(); ++task) {
    TACTUS_RETURN_IF_ERROR(fit.FitTask(task, Progress()));
  }
  const Model model = fit.TakeModel();
  return absl::OkStatus();
}

absl::Status FitRunExample(const FitRun& run) {
  TACTUS_RETURN_IF_ERROR(run.GoOn());
  run.Report({.phase = "fit HMMs", .part = "hmm/SU/0", .iteration = 1});
  return absl::OkStatus();
}

std::optional<std::string> Read(absl::string_view part);
absl::Status Write(absl::string_view part, const std::string& bytes);

void FitJournalExample(const Contacts& contacts, const FitOptions& options,
                       const ParallelFor& RunOnThreads,
                       const Progress& progress) {
  class Files : public FitJournal {
   public:
    std::optional<std::string> Find(absl::string_view part) override {
      return Read(part);
    }
    absl::Status Put(absl::string_view part, std::string bytes) override {
      return Write(part, bytes);
    }
  };
  Files files;
  FitModel(contacts, options, RunOnThreads, progress, &files);
}

absl::Status ArchiveExample(LstmCheckpoint checkpoint, absl::string_view part) {
  ByteWriter writer;
  writer(checkpoint.network, checkpoint.history);
  ByteReader reader(writer.bytes());
  reader(checkpoint.network, checkpoint.history);
  if (!reader.AtEnd()) return CheckpointInvalid(part, "it is cut off");
  return absl::OkStatus();
}

void FitFieldsExample(const FitOptions& options) {
  const auto model = std::make_unique<InputSpec>();
  ByteWriter writer;
  writer(options, *model);
}

absl::Status SavedPartsExample(FitJournal* journal, const Contacts& contacts,
                               const FitOptions& options) {
  const auto Train = [] { return HmmMixture(); };
  const SavedParts saved(journal, contacts, options);
  TACTUS_ASSIGN_OR_RETURN(auto mixture, saved.Find<HmmMixture>("hmm/SU"));
  if (!mixture) {
    mixture = Train();
    TACTUS_RETURN_IF_ERROR(saved.Put("hmm/SU", *mixture));
  }
  return absl::OkStatus();
}

void ContactFramesExample(const FeatureVector& signals) {
  ContactFrames frames;
  frames.push_back({IdealSample(signals), true});
  const ContactFrame first = frames[0];
}

void LstmInputsExample(const VariedContacts& contacts,
                       const std::vector<std::string>& class_names,
                       const InputSpec& spec, LstmCheckpoint checkpoint,
                       const LstmTrainOptions& options) {
  const LstmInputs inputs(contacts, class_names, spec,
                          {.keep = true, .with_targets = true});
  const auto source = inputs.Source(/*with_targets=*/false);
  TrainLstm(checkpoint, *source, {}, options);
}

absl::Status UsableExample(Contacts contacts, const FitOptions& options) {
  std::erase_if(contacts, [&](const LabelledContact* contact) {
    return !IsUsable(*contact, options);
  });
  TACTUS_RETURN_IF_ERROR(CheckUsable(contacts, options));
  return absl::OkStatus();
}

void VariedContactsExample(const Contacts& contacts,
                           const std::vector<ModelInput>& inputs,
                           const StepIntervals& steps, uint64_t seed) {
  const VariedContacts varied(contacts, {.copies = 4, .pace = 3}, seed);
  LabelledContact made;
  for (size_t i = 0; i < varied.size(); ++i) {
    MakeSequence(varied.Get(i, made), inputs, steps);
  }
}

absl::Status ChooseCuesExample(FitOptions& options) {
  TACTUS_RETURN_IF_ERROR(
      AddLstmCues("with_cues", {"force_pitch_short"}, options));
  TACTUS_RETURN_IF_ERROR(LeaveOutCues("without_cues", {"log_drag"}, options));
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
  auto inputs = FitInputs(VariedContacts(contacts), cues, {});
  std::vector<double> rows = MakeSequence(contact, inputs, steps);
}

void CueTableExample(const VariedContacts& contacts,
                     const std::vector<Cue>& cues,
                     const ParallelFor& RunOnThreads) {
  struct Range {
    void Add(double) {}
  };
  std::vector<Range> ranges(cues.size());
  const auto Use = [](std::span<const double>) {};
  CueTable table(contacts, cues, {.steps = {5, 20}});
  table.Walk(RunOnThreads, [&](std::span<const double> values) {
    for (size_t i = 0; i < values.size(); ++i) ranges[i].Add(values[i]);
  });
  for (size_t step = 0; step < table.steps(3); ++step) {
    Use(table.values(3, step));
  }
}

void VariationExample(const LabelledContact& contact, uint64_t seed) {
  Random random(seed);
  LabelledContact other = Vary(contact, {.pace = 1.4, .load = 0.5}, random);
}

}  // namespace tactus::examples
