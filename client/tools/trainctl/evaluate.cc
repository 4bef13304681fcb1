// trainctl evaluate: measures how well the trials of a file are classified.
#include "core/eval/evaluate.h"

#include <filesystem>
#include <iostream>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/tools/figures/figure.h"
#include "client/tools/trainctl/chosen_preset.h"
#include "client/tools/trainctl/command.h"
#include "client/tools/trainctl/evaluate_figures.h"
#include "client/tools/trainctl/evaluate_page.h"
#include "client/tools/trainctl/evaluate_report.h"
#include "client/tools/trainctl/exit_code.h"
#include "client/tools/trainctl/fit_flags.h"
#include "client/tools/trainctl/progress_display.h"
#include "client/tools/trainctl/text.h"
#include "core/base/errors.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/data/draft_file.h"
#include "core/eval/unknown.h"
#include "core/train/contact_set.h"

namespace tactus::client {
namespace {

constexpr char kLeaveOneCategoryOut[] = "leave-one-category-out";

struct Flags {
  std::string data;
  std::string protocol;
  std::optional<int> folds;
  std::string model;
  // Empty: what a server would answer with.
  std::string algorithm;
  std::string layout;
  std::string figures;
  std::string report;
  bool json = false;
  FitFlags fit;
};

// Refuses flags that would have no effect.
absl::Status Check(const Flags& flags) {
  if (flags.data.empty()) {
    return WithExitCode(InvalidConfig("--data and --dataset", "both absent",
                                      "a trial file, or a dataset of a server"),
                        kExitUsage);
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
  if (flags.protocol == kLeaveOneCategoryOut &&
      !(flags.algorithm.empty() && flags.figures.empty() &&
        flags.report.empty())) {
    return InvalidConfig(
        !flags.algorithm.empty() ? "--algorithm"
        : !flags.figures.empty() ? "--figures"
                                 : "--report",
        absl::StrCat("given with ", kLeaveOneCategoryOut),
        "absent: the HMMs alone estimate the probability of unknown");
  }
  return absl::OkStatus();
}

absl::StatusOr<Algorithm> ChosenAlgorithm(const Flags& flags, bool has_lstms) {
  if (flags.algorithm.empty()) return ServedAlgorithm(has_lstms);
  return ParseAlgorithm(flags.algorithm);
}

absl::Status Draw(const Flags& flags, const Evaluation& result) {
  std::filesystem::create_directories(flags.figures);
  const NamedEvaluation named{std::string(AlgorithmName(result.algorithm)),
                              &result, 5};
  TACTUS_RETURN_IF_ERROR(DrawFigure(AnytimePlot(named, Experiment::kSimulation),
                                    flags.figures + "/anytime.png"));
  return DrawFigure(ReliabilityPlot(named), flags.figures + "/reliability.png");
}

// Measures how well `unknown` detects contacts of a category that was left out
// of training.
absl::Status RunUnknown(const Flags& flags) {
  ProgressDisplay display;
  TACTUS_ASSIGN_OR_RETURN(
      const LoadedContacts loaded,
      LoadContacts(flags.data, flags.layout, display.progress()));
  TACTUS_ASSIGN_OR_RETURN(const ChosenOptions chosen,
                          ChooseOptions(flags.fit, loaded, display.progress()));
  TACTUS_ASSIGN_OR_RETURN(const auto results,
                          EvaluateUnknown(chosen.contacts, chosen.options,
                                          RunOnThreads, display.progress()));
  display.Clear();
  if (flags.json) {
    std::cout << JsonText(Json({{"protocol", flags.protocol},
                                {"seed", flags.fit.seed},
                                {"preset", chosen.preset},
                                {"choice", ChoiceToJson(chosen)},
                                {"categories", UnknownToJson(results)},
                                {"seconds", SecondsSinceStart()}}))
              << "\n";
  } else {
    std::cout << ChoiceText(chosen) << UnknownText(results)
              << absl::StrFormat("seed %d, %.1f s\n", flags.fit.seed,
                                 SecondsSinceStart());
  }
  return absl::OkStatus();
}

// An evaluation and what was evaluated.
struct Run {
  Evaluation result;
  std::string features;
  // Empty of a bundle.
  ChosenOptions chosen;
};

absl::StatusOr<Run> RunProtocol(const Flags& flags,
                                const LoadedContacts& loaded,
                                const Progress& progress) {
  // Nearest neighbours are not fitted by a preset.
  FitFlags fit = flags.fit;
  if (flags.algorithm == "1nn" && fit.preset.empty()) fit.preset = "tuned";
  TACTUS_ASSIGN_OR_RETURN(ChosenOptions chosen,
                          ChooseOptions(fit, loaded, progress));
  const FitOptions& options = chosen.options;
  TACTUS_ASSIGN_OR_RETURN(const Algorithm algorithm,
                          ChosenAlgorithm(flags, options.lstm.networks > 0));
  TACTUS_ASSIGN_OR_RETURN(
      const Protocol protocol,
      ParseProtocol(flags.protocol,
                    flags.folds.value_or(Protocol::kDefaultFolds)));
  TACTUS_ASSIGN_OR_RETURN(Evaluation result,
                          EvaluateProtocol(chosen.contacts, protocol, algorithm,
                                           options, RunOnThreads, progress));
  return Run{std::move(result), FeaturesToString(options.features),
             std::move(chosen)};
}

absl::StatusOr<Run> RunModel(const Flags& flags,
                             const std::shared_ptr<const CompiledModel>& model,
                             const LoadedContacts& loaded,
                             const Progress& progress) {
  for (const LabelledContact& contact : loaded.contacts) {
    TACTUS_RETURN_IF_ERROR(CheckFits(contact, model->model()));
  }
  TACTUS_ASSIGN_OR_RETURN(const Algorithm algorithm,
                          ChosenAlgorithm(flags, !model->lstms().empty()));
  TACTUS_ASSIGN_OR_RETURN(Evaluation result,
                          EvaluateModel(model, loaded.Pointers(), algorithm,
                                        RunOnThreads, progress));
  return Run{std::move(result),
             FeaturesToString(FeaturesUsed(model->model().inputs)),
             {}};
}

std::string Title(const Flags& flags, const Run& run) {
  const bool reduced =
      flags.algorithm == "fused" && run.result.algorithm != Algorithm::kFused;
  return absl::StrFormat(
      "%s, %s%s, features %s",
      flags.model.empty()
          ? flags.protocol
          : std::filesystem::path(flags.model).filename().string(),
      AlgorithmName(run.result.algorithm),
      reduced ? " (there is no LSTM to fuse)" : "", run.features);
}

void Print(const Flags& flags, const Run& run, const Json& evaluation,
           int trials) {
  const bool fitted = flags.model.empty();
  if (flags.json) {
    Json json = {{"protocol", fitted ? flags.protocol : "model"}};
    json["features"] = run.features;
    json.update(evaluation);
    if (fitted) {
      json["preset"] = run.chosen.preset;
      json["choice"] = ChoiceToJson(run.chosen);
      json["seed"] = flags.fit.seed;
    }
    json["seconds"] = SecondsSinceStart();
    std::cout << JsonText(json) << "\n";
    return;
  }
  std::cout << ChoiceText(run.chosen) << Title(flags, run) << ": "
            << EvaluationText(evaluation);
  if (fitted) {
    std::cout << absl::StrFormat("preset %s, seed %d, ", run.chosen.preset,
                                 flags.fit.seed);
  }
  std::cout << absl::StrFormat("%s trials, %.1f s\n", WithCommas(trials),
                               SecondsSinceStart());
}

absl::Status WritePage(const Flags& flags, const Run& run,
                       const LoadedContacts& loaded, const Json& evaluation) {
  std::error_code error;
  std::filesystem::create_directories(flags.report, error);
  if (error) return IoError(flags.report, error.message());
  return WriteFileBytes(
      (std::filesystem::path(flags.report) / "index.html").string(),
      EvaluationPage(
          absl::StrCat(Title(flags, run), ", ", flags.data), evaluation,
          WorstTrials(run.result, flags.model.empty() ? run.chosen.contacts
                                                      : loaded.Pointers())));
}

absl::Status RunEvaluate(const Flags& flags) {
  TACTUS_RETURN_IF_ERROR(Check(flags));
  if (flags.protocol == kLeaveOneCategoryOut) return RunUnknown(flags);
  std::shared_ptr<const CompiledModel> model;
  if (!flags.model.empty()) {
    TACTUS_ASSIGN_OR_RETURN(model, LoadModel(flags.model));
  }
  ProgressDisplay display;
  TACTUS_ASSIGN_OR_RETURN(
      const LoadedContacts loaded,
      LoadContacts(flags.data, flags.layout, display.progress(),
                   model ? model->model().release_after_s : kNeverReleased));
  TACTUS_ASSIGN_OR_RETURN(
      const Run run, model ? RunModel(flags, model, loaded, display.progress())
                           : RunProtocol(flags, loaded, display.progress()));
  display.Clear();
  if (!flags.figures.empty()) {
    TACTUS_RETURN_IF_ERROR(Draw(flags, run.result));
  }
  const Json evaluation = EvaluationToJson(run.result, loaded.trials);
  if (!flags.report.empty()) {
    TACTUS_RETURN_IF_ERROR(WritePage(flags, run, loaded, evaluation));
  }
  Print(flags, run, evaluation, loaded.trials);
  return absl::OkStatus();
}

}  // namespace

void AddEvaluate(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<Flags>();
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
  command->add_option("--figures", flags->figures,
                      "Folder for figures of accuracy and reliability");
  command->add_option("--report", flags->report,
                      "Folder for index.html: confusion matrix, recall and "
                      "precision per class, accuracy over time, worst trials");
  command->add_flag("--json", flags->json, "Print one JSON object on stdout");
  flags->fit.Add(*command);
  command->callback([=] { select([=] { return RunEvaluate(*flags); }); });
}

}  // namespace tactus::client
