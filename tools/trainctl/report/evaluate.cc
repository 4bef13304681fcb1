// trainctl evaluate: measures how well the trials of a file are classified.
#include "core/eval/evaluate.h"

#include <filesystem>
#include <iostream>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/base/version.h"
#include "core/classify/contact_pipeline.h"
#include "core/contacts/contact_set.h"
#include "core/contacts/copies.h"
#include "core/contacts/trained_on.h"
#include "core/data/trial_layout.h"
#include "core/eval/baselines.h"
#include "core/eval/unknown.h"
#include "core/files/draft_file.h"
#include "tools/figures/figure.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/exit_code.h"
#include "tools/trainctl/fit/choice_text.h"
#include "tools/trainctl/fit/fit_flags.h"
#include "tools/trainctl/progress_display.h"
#include "tools/trainctl/report/evaluate_answers.h"
#include "tools/trainctl/report/evaluate_figures.h"
#include "tools/trainctl/report/evaluate_page.h"
#include "tools/trainctl/report/evaluate_pictures.h"
#include "tools/trainctl/report/evaluate_report.h"
#include "tools/trainctl/report/next_recordings.h"
#include "tools/trainctl/report/touch_report.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

constexpr char kLeaveOneCategoryOut[] = "leave-one-category-out";

struct EvaluateFlags {
  std::string data;
  std::string protocol;
  std::optional<int> folds;
  std::string model;
  // Empty: what a server would answer with.
  std::string algorithm;
  std::string layout;
  std::string where;
  std::string figures;
  std::string report;
  std::string answers;
  bool curve = false;
  bool json = false;
  FitFlags fit;
};

// Refuses flags that would have no effect.
absl::Status Check(const EvaluateFlags& flags) {
  if (flags.data.empty()) {
    return InvalidConfig("--data and --dataset", "both absent",
                         "a trial file, or a dataset of a server");
  }
  if (flags.protocol.empty() == flags.model.empty()) {
    return InvalidConfig("--protocol and --model",
                         flags.model.empty() ? "both absent" : "both given",
                         "exactly one of the two");
  }
  if (const std::string given = flags.fit.FirstGiven();
      !flags.model.empty() && !given.empty()) {
    return InvalidConfig(given, "given with --model",
                         "absent: the bundle is not fitted again");
  }
  if (flags.folds && flags.protocol != "k-fold") {
    return InvalidConfig("--folds", *flags.folds,
                         "given with --protocol=k-fold only");
  }
  if (flags.curve &&
      (!flags.model.empty() || flags.protocol == kLeaveOneCategoryOut ||
       flags.algorithm == "1nn")) {
    return InvalidConfig("--curve", "given without models that are fitted",
                         "absent, or given with a protocol that fits models");
  }
  if (flags.protocol == kLeaveOneCategoryOut) {
    const std::pair<const char*, const std::string*> unused[] = {
        {"--algorithm", &flags.algorithm},
        {"--figures", &flags.figures},
        {"--report", &flags.report},
        {"--answers", &flags.answers}};
    for (const auto& [flag, value] : unused) {
      if (value->empty()) continue;
      return InvalidConfig(
          flag, absl::StrCat("given with ", kLeaveOneCategoryOut),
          "absent: only the probability of unknown is measured");
    }
  }
  // Found before the trials are read.
  absl::Status names = absl::OkStatus();
  if (!flags.protocol.empty() && flags.protocol != kLeaveOneCategoryOut) {
    names.Update(ParseProtocol(flags.protocol).status());
  }
  if (!flags.algorithm.empty()) {
    names.Update(ParseAlgorithm(flags.algorithm).status());
  }
  return names.ok() ? names : WithExitCode(names, kExitUsage);
}

absl::StatusOr<Algorithm> ChosenAlgorithm(const EvaluateFlags& flags,
                                          bool has_lstms) {
  if (flags.algorithm.empty()) return ServedAlgorithm(has_lstms);
  return ParseAlgorithm(flags.algorithm);
}

absl::Status Draw(const EvaluateFlags& flags, const Evaluation& result) {
  const NamedEvaluation named{std::string(AlgorithmName(result.algorithm)),
                              &result, 5};
  TACTUS_RETURN_IF_ERROR(
      DrawFigure(AnytimePlot(named, ComparableExperiment(result)),
                 flags.figures + "/anytime.png"));
  return DrawFigure(ReliabilityPlot(named), flags.figures + "/reliability.png");
}

// Measures how well `unknown` detects contacts of a class that was left out
// of training.
absl::Status RunUnknown(const EvaluateFlags& flags) {
  ProgressDisplay display;
  TACTUS_ASSIGN_OR_RETURN(const LoadedContacts loaded,
                          LoadContacts({flags.data, flags.layout, flags.where},
                                       display.progress()));
  TACTUS_ASSIGN_OR_RETURN(const ChosenOptions chosen,
                          flags.fit.Choose(loaded, display));
  TACTUS_ASSIGN_OR_RETURN(const auto results,
                          EvaluateUnknown(chosen.contacts, chosen.options,
                                          RunOnThreads, display.progress()));
  display.Clear();
  RemarkCopies(chosen.contacts);
  if (flags.json) {
    std::cout << JsonText(Json({{"protocol", flags.protocol},
                                {"seed", flags.fit.spec.seed},
                                {"preset", chosen.preset},
                                {"choice", ChoiceToJson(chosen.choice)},
                                {"categories", UnknownToJson(results)},
                                {"seconds", SecondsSinceStart()}}))
              << "\n";
  } else {
    std::cout << ChoiceText(chosen.choice) << UnknownText(results)
              << absl::StrFormat("seed %d, %.1f s\n", flags.fit.spec.seed,
                                 SecondsSinceStart());
  }
  return absl::OkStatus();
}

// An evaluation and what was evaluated.
struct EvaluationRun {
  Evaluation result;
  std::string features;
  Learner learner = Learner::kHmms;
  // Empty of a bundle.
  ChosenOptions chosen;
  // What a bundle was fitted to.
  TrainedOn trained = {};
  std::optional<LearningCurve> curve = {};
};

absl::StatusOr<EvaluationRun> RunProtocol(const EvaluateFlags& flags,
                                          const LoadedContacts& loaded,
                                          ProgressDisplay& display) {
  const Progress progress = display.progress();
  // Nearest neighbours are not fitted by a preset.
  FitFlags fit = flags.fit;
  if (flags.algorithm == "1nn" && fit.spec.preset.empty())
    fit.spec.preset = "tuned";
  TACTUS_ASSIGN_OR_RETURN(
      const Protocol protocol,
      ParseProtocol(flags.protocol,
                    flags.folds.value_or(Protocol::kDefaultFolds)));
  TACTUS_ASSIGN_OR_RETURN(ChosenOptions chosen,
                          fit.Choose(loaded, display, protocol));
  const FitOptions& options = chosen.options;
  TACTUS_ASSIGN_OR_RETURN(const Algorithm algorithm,
                          ChosenAlgorithm(flags, options.lstm.networks > 0));
  TACTUS_ASSIGN_OR_RETURN(Evaluation result,
                          EvaluateProtocol(chosen.contacts, protocol, algorithm,
                                           options, RunOnThreads, progress));
  EvaluationRun run{std::move(result), FeaturesToString(options.features),
                    options.learner, std::move(chosen)};
  if (flags.curve) {
    TACTUS_ASSIGN_OR_RETURN(
        run.curve,
        MeasureLearningCurve(run.chosen.contacts, protocol, run.chosen.options,
                             RunOnThreads, progress));
  }
  return run;
}

absl::StatusOr<EvaluationRun> RunModel(
    const EvaluateFlags& flags,
    const std::shared_ptr<const CompiledModel>& model,
    const LoadedContacts& loaded, const Progress& progress) {
  for (const LabelledContact& contact : loaded.contacts) {
    TACTUS_RETURN_IF_ERROR(CheckFits(contact, model->model()));
  }
  TACTUS_ASSIGN_OR_RETURN(const Algorithm algorithm,
                          ChosenAlgorithm(flags, !model->lstms().empty()));
  TACTUS_ASSIGN_OR_RETURN(Evaluation result,
                          EvaluateModel(model, loaded.Pointers(), algorithm,
                                        RunOnThreads, progress));
  return EvaluationRun{
      std::move(result),
      FeaturesToString(FeaturesUsed(model->model().inputs)),
      LearnerOf(model->model()),
      {},
      FindTrainedOn(model->model().provenance, loaded.Pointers(),
                    {.sha256 = loaded.data_sha256, .name = flags.data})};
}

// "lstm", "fused", and for "hmm" what is in its place.
std::string AnswersName(const EvaluationRun& run) {
  if (run.result.algorithm != Algorithm::kHmm || run.learner == Learner::kHmms)
    return std::string(AlgorithmName(run.result.algorithm));
  return LearnerText(run.learner);
}

std::string Title(const EvaluateFlags& flags, const EvaluationRun& run) {
  const bool reduced =
      flags.algorithm == "fused" && run.result.algorithm != Algorithm::kFused;
  return absl::StrFormat(
      "%s, %s%s, features %s",
      flags.model.empty()
          ? flags.protocol
          : std::filesystem::path(flags.model).filename().string(),
      AnswersName(run), reduced ? " (there is no LSTM to fuse)" : "",
      run.features);
}

// What evaluations by a bundle say of the trials that it was fitted to; a model
// of a protocol has never seen those that it is tested on.
Json TrainedOnToJson(const TrainedOn& trained) {
  constexpr const char* kBases[] = {"unknown", "frames", "data", "name"};
  return {{"basis", kBases[static_cast<int>(trained.basis)]},
          {"contacts", trained.contacts},
          {"tested", trained.tested}};
}

void Print(const EvaluateFlags& flags, const EvaluationRun& run,
           const Json& evaluation, int trials) {
  const bool fitted = flags.model.empty();
  if (flags.json) {
    Json json = {{"protocol", fitted ? flags.protocol : "model"}};
    json["features"] = run.features;
    json["learner"] = LearnerText(run.learner);
    json["trained_on_data"] = run.trained.contacts > 0;
    if (!fitted) {
      if (run.trained.basis == TrainingBasis::kUnknown) {
        json["trained_on_data"] = nullptr;
      }
      json["trained_on"] = TrainedOnToJson(run.trained);
    }
    json.update(evaluation);
    if (fitted) {
      json["preset"] = run.chosen.preset;
      json["choice"] = ChoiceToJson(run.chosen.choice);
      json["candidates"] = CandidatesToJson(run.chosen.choice);
      json["seed"] = flags.fit.spec.seed;
    }
    json["seconds"] = SecondsSinceStart();
    std::cout << JsonText(json) << "\n";
    return;
  }
  const std::string warning = fitted ? "" : TrainedOnText(run.trained);
  if (!warning.empty()) std::cout << warning << "\n";
  std::cout << ChoiceText(run.chosen.choice) << Title(flags, run) << ": "
            << EvaluationText(evaluation);
  if (evaluation.contains("contacts")) {
    std::cout << TouchesText(evaluation["contacts"]);
  }
  std::cout << NextRecordingsText(evaluation);
  if (fitted) {
    std::cout << absl::StrFormat("preset %s, seed %d, ", run.chosen.preset,
                                 flags.fit.spec.seed);
  }
  std::cout << absl::StrFormat("%s trials, %.1f s\n", WithCommas(trials),
                               SecondsSinceStart());
}

using Contacts = std::vector<const LabelledContact*>;

// In the order of the outcomes.
Contacts TestedContacts(const EvaluateFlags& flags, const EvaluationRun& run,
                        const LoadedContacts& loaded) {
  return flags.model.empty() ? run.chosen.contacts : loaded.Pointers();
}

// The baselines are tested as the evaluation is. A bundle has not been trained
// here, so the baselines get folds of the contacts that it is tested on. Null
// if there are too few contacts for folds.
absl::StatusOr<Json> CountBaselines(const EvaluateFlags& flags,
                                    const Contacts& contacts) {
  constexpr int kFolds = 5;
  Protocol protocol(Protocol::kKFold, kFolds);
  std::string tested = absl::StrFormat(
      "The baselines use %d folds of these trials: each trial is answered by "
      "the trials of the other folds.",
      kFolds);
  if (flags.model.empty()) {
    TACTUS_ASSIGN_OR_RETURN(
        protocol, ParseProtocol(flags.protocol,
                                flags.folds.value_or(Protocol::kDefaultFolds)));
    tested = absl::StrCat("The baselines use the same folds as the models: ",
                          flags.protocol, ".");
  }
  const auto folds = MakeFolds(contacts, protocol);
  if (!folds.ok()) return Json(nullptr);
  TACTUS_ASSIGN_OR_RETURN(const Baselines baselines,
                          MeasureBaselines(contacts, *folds));
  return BaselinesToJson(baselines, tested);
}

std::vector<std::pair<std::string, std::string>> Facts(
    const EvaluateFlags& flags, const EvaluationRun& run,
    const Contacts& contacts) {
  std::vector<std::pair<std::string, std::string>> facts = {
      {"data", flags.data}};
  if (!flags.where.empty()) facts.emplace_back("trials where", flags.where);
  if (!contacts.empty()) {
    const LabelledContact& first = *contacts.front();
    std::string skin = "none: ideal signals";
    if (!IsIdeal(first)) {
      skin = SkinText(first.layout);
      skin = std::string(
          absl::StripPrefix(absl::StripSuffix(skin, "\n"), "skin "));
    }
    facts.emplace_back("skin", skin);
    facts.emplace_back("sample rate",
                       absl::StrFormat("%g Hz", first.sample_rate_hz));
  }
  if (flags.model.empty()) {
    facts.emplace_back(
        "protocol",
        flags.protocol == "k-fold"
            ? absl::StrFormat("k-fold, %d folds",
                              flags.folds.value_or(Protocol::kDefaultFolds))
            : flags.protocol);
    facts.emplace_back(
        "preset",
        absl::StrCat(run.chosen.preset,
                     run.chosen.choice ? ", chosen by inner folds" : ""));
    facts.emplace_back("seed", absl::StrCat(flags.fit.spec.seed));
  } else {
    facts.emplace_back("bundle", flags.model);
  }
  facts.emplace_back("algorithm", AnswersName(run));
  facts.emplace_back("features", run.features);
  facts.emplace_back("program", absl::StrCat("trainctl ", kVersion));
  facts.emplace_back("command", CommandLine());
  return facts;
}

absl::Status WritePage(const EvaluateFlags& flags, const EvaluationRun& run,
                       const std::shared_ptr<const CompiledModel>& model,
                       const LoadedContacts& loaded, const Json& evaluation,
                       const Progress& progress) {
  const Contacts contacts = TestedContacts(flags, run, loaded);
  SkinLayout layout;
  if (!flags.layout.empty()) {
    TACTUS_ASSIGN_OR_RETURN(layout, ReadLayoutFile(flags.layout));
  }
  EvaluationPageParts parts;
  parts.title = absl::StrCat(
      "Evaluation on ", std::filesystem::path(flags.data).filename().string());
  parts.facts = Facts(flags, run, contacts);
  if (!flags.model.empty()) parts.warning = TrainedOnText(run.trained);
  parts.evaluation = evaluation;
  TACTUS_ASSIGN_OR_RETURN(parts.baselines, CountBaselines(flags, contacts));
  parts.worst = WorstTrials(run.result, contacts);
  TACTUS_ASSIGN_OR_RETURN(parts.pictures,
                          DrawEvaluation(run.result, contacts, progress));
  TACTUS_ASSIGN_OR_RETURN(
      parts.pictures.worst,
      DrawTrials(flags.data, parts.worst, layout, model, progress));
  return WriteFileBytes(
      (std::filesystem::path(flags.report) / "index.html").string(),
      EvaluationPage(parts));
}

absl::Status RunEvaluate(const EvaluateFlags& flags) {
  TACTUS_RETURN_IF_ERROR(Check(flags));
  // Missing programs and folders are found before the work, not after it.
  for (const std::string& folder : {flags.report, flags.figures}) {
    if (folder.empty()) continue;
    TACTUS_RETURN_IF_ERROR(MakeFolder(folder));
    TACTUS_RETURN_IF_ERROR(CheckPictures());
  }
  if (!flags.answers.empty()) {
    TACTUS_RETURN_IF_ERROR(DraftFile::Create(flags.answers).status());
  }
  if (flags.protocol == kLeaveOneCategoryOut) return RunUnknown(flags);
  std::shared_ptr<const CompiledModel> model;
  if (!flags.model.empty()) {
    TACTUS_ASSIGN_OR_RETURN(model, LoadModel(flags.model));
  }
  ProgressDisplay display;
  TACTUS_ASSIGN_OR_RETURN(
      const LoadedContacts loaded,
      LoadContacts({flags.data, flags.layout, flags.where}, display.progress(),
                   {.release_after_s = model ? model->model().release_after_s
                                             : kNeverReleased},
                   model ? MostContacts(model->model(), {}) : 0));
  TACTUS_ASSIGN_OR_RETURN(
      const EvaluationRun run,
      model ? RunModel(flags, model, loaded, display.progress())
            : RunProtocol(flags, loaded, display));
  if (!flags.figures.empty()) {
    TACTUS_RETURN_IF_ERROR(Draw(flags, run.result));
  }
  if (!flags.answers.empty()) {
    TACTUS_RETURN_IF_ERROR(WriteFileBytes(
        flags.answers,
        AnswersCsv(run.result, TestedContacts(flags, run, loaded))));
  }
  const Contacts tested = TestedContacts(flags, run, loaded);
  // Trials that were left out were neither felt nor missed; a trial with
  // touches may have any number of contacts.
  const int trials = static_cast<int>(tested.size()) + loaded.never_felt;
  Json evaluation = EvaluationToJson(run.result, trials);
  NameConfusions(WrongAnswers(run.result, tested), evaluation);
  evaluation["duplicates"] = FindCopies(tested).size();
  evaluation["groups"] = GroupsToJson(run.result, tested);
  evaluation["learning_curve"] = CurveToJson(run.curve);
  if (loaded.touches) {
    evaluation["contacts"] = TouchesToJson(*loaded.touches, run.result, tested);
  }
  if (!flags.report.empty()) {
    TACTUS_RETURN_IF_ERROR(
        WritePage(flags, run, model, loaded, evaluation, display.progress()));
  }
  display.Clear();
  RemarkCopies(tested);
  Print(flags, run, evaluation, trials);
  return absl::OkStatus();
}

}  // namespace

void AddEvaluate(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<EvaluateFlags>();
  CLI::App* command = app.add_subcommand(
      "evaluate", "Measure the accuracy of a bundle, or of a protocol");
  command->add_option("--data", flags->data, "Trial file");
  command->add_option("--protocol", flags->protocol,
                      "loco, leave-one-out, leave-one-material-out, k-fold, or "
                      "leave-one-category-out for the detection of unknown");
  command->add_option("--folds", flags->folds, "Number of folds of k-fold");
  command->add_option("--model", flags->model,
                      "Bundle to evaluate, instead of --protocol");
  command->add_option("--algorithm", flags->algorithm,
                      "fused, hmm, lstm or 1nn; default: what a server would "
                      "answer with, which is fused if there are LSTMs");
  command->add_option("--layout", flags->layout,
                      "JSON file with the skin of trials that carry none");
  command->add_option("--where", flags->where, kWhereHelp);
  command->add_option("--figures", flags->figures,
                      "Folder for figures of accuracy and reliability");
  command->add_option("--report", flags->report,
                      "Folder for index.html, a page that needs no other file: "
                      "accuracy beside baselines, confusion matrix, recall and "
                      "precision per class, accuracy over time, reliability, "
                      "time to decision, pictures of the worst trials");
  command->add_option("--answers", flags->answers,
                      "CSV file for the answer to every felt trial: trial, "
                      "label, answer, probability of each class");
  command->add_flag("--curve", flags->curve,
                    "Also fit to 5, 10, 20 and 50 trials of a class, and say "
                    "whether more recordings would help");
  command->add_flag("--json", flags->json, "Print one JSON object on stdout");
  flags->fit.Add(*command);
  command->callback([=] { select([=] { return RunEvaluate(*flags); }); });
}

}  // namespace tactus::internal::client
