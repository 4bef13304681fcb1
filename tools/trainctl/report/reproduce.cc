// trainctl reproduce: computes the paper's result tables and compares them.
#include <algorithm>
#include <iostream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/eval/evaluate.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/data/simulate_jobs.h"
#include "tools/trainctl/progress_display.h"
#include "tools/trainctl/report/reproduce_data.h"
#include "tools/trainctl/report/reproduce_report.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

struct ReproduceFlags {
  std::vector<std::string> only = {"hmm", "lstm", "1nn"};
  std::vector<std::string> experiments = {"simulation", "cody"};
  std::string figures;
  // Noise of ideal signals; empty for the default.
  std::string noise;
  uint64_t seed = 1;
  bool json = false;
};

// The rows that are asked for.
struct Selection {
  std::vector<Algorithm> algorithms;
  std::vector<Experiment> experiments;
};

absl::StatusOr<Selection> Select(const ReproduceFlags& flags) {
  Selection selection;
  for (const std::string& name : flags.only) {
    TACTUS_ASSIGN_OR_RETURN(const Algorithm algorithm, ParseAlgorithm(name));
    if (algorithm == Algorithm::kFused) {
      return InvalidConfig("--only", name, "hmm, lstm or 1nn");
    }
    selection.algorithms.push_back(algorithm);
  }
  for (const std::string& name : flags.experiments) {
    if (name == SourceOf(Experiment::kSimulation).name) {
      selection.experiments.push_back(Experiment::kSimulation);
    } else if (name == SourceOf(Experiment::kCody).name) {
      selection.experiments.push_back(Experiment::kCody);
    } else {
      return InvalidConfig("--experiment", name, "simulation or cody");
    }
  }
  const bool signals =
      std::ranges::count(selection.experiments, Experiment::kSimulation) > 0;
  if (!flags.noise.empty() && !signals) {
    return InvalidConfig("--noise with Cody alone", flags.noise,
                         "absent: a skin's noise is absolute");
  }
  return selection;
}

// Computes one row. A row that fails holds the reason; the others continue.
ReproducedRow Reproduce(Experiment experiment, const PaperRow& paper,
                        const LoadedContacts& data, uint64_t seed,
                        const Progress& progress) {
  ReproducedRow row;
  row.experiment = experiment;
  row.paper = paper;
  const double begin = SecondsSinceStart();
  const auto result = [&]() -> absl::StatusOr<Evaluation> {
    TACTUS_ASSIGN_OR_RETURN(FitOptions options, FitPreset("paper"));
    options.features = PaperFeatures(paper.features);
    options.seed = seed;
    // Calibration does not change the answers that the table counts.
    options.calibrate = false;
    return EvaluateProtocol(data.Pointers(), Protocol::kLeaveOneConditionOut,
                            paper.algorithm, options, RunOnThreads, progress);
  }();
  row.seconds = SecondsSinceStart() - begin;
  if (!result.ok()) {
    row.reason = std::string(result.status().message());
    return row;
  }
  row.trials = data.trials;
  row.never_felt = data.never_felt;
  row.ours_percent = 100 * Accuracy(result->final);
  row.class_names = result->class_names;
  row.confusion = CountConfusion(result->final,
                                 static_cast<int>(result->class_names.size()));
  return row;
}

// Appends the rows of one experiment to `rows_json`. Returns how many could not
// be computed.
absl::StatusOr<int> RunExperiment(const ReproduceFlags& flags,
                                  const Selection& selection,
                                  Experiment experiment,
                                  const LoadedContacts& data, Json& rows_json) {
  ProgressDisplay display;
  const std::string name(SourceOf(experiment).name);
  if (!flags.json) std::cout << TableHeading(experiment) << std::flush;
  std::vector<ReproducedRow> rows;
  int failed = 0;
  for (const PaperRow& paper : PaperTable(experiment)) {
    if (std::find(selection.algorithms.begin(), selection.algorithms.end(),
                  paper.algorithm) == selection.algorithms.end()) {
      continue;
    }
    const std::string phase = absl::StrCat(
        name, ": ", PaperName(paper.algorithm), " ", paper.features);
    rows.push_back(Reproduce(experiment, paper, data, flags.seed,
                             display.progress().Part(phase, 1)));
    display.Clear();
    failed += !rows.back().ours_percent.has_value();
    rows_json.push_back(RowToJson(rows.back()));
    if (!flags.json) std::cout << TableLine(rows.back()) << std::flush;
  }
  if (!flags.json) {
    std::cout << absl::StrFormat(
        "Accuracies are of %s\n",
        FeltContacts(data.trials - data.never_felt, data.trials));
    std::cout << ConfusionBlocks(rows) << "\n";
  }
  if (!flags.figures.empty()) {
    TACTUS_RETURN_IF_ERROR(WriteFigures(rows, flags.figures));
  }
  return failed;
}

// The contacts of all experiments, so that one that cannot be simulated ends
// the command before the long fits.
absl::StatusOr<std::vector<LoadedContacts>> SimulateAll(
    const ReproduceFlags& flags, const Selection& selection) {
  ProgressDisplay display;
  std::vector<LoadedContacts> data;
  for (const Experiment experiment : selection.experiments) {
    const std::string phase =
        absl::StrCat(SourceOf(experiment).name, ": simulate contacts");
    TACTUS_ASSIGN_OR_RETURN(
        data.emplace_back(),
        SimulateExperiment(experiment, flags.seed, flags.noise,
                           display.progress().Part(phase, 1)));
  }
  return data;
}

absl::Status RunReproduce(const ReproduceFlags& flags) {
  TACTUS_ASSIGN_OR_RETURN(const Selection selection, Select(flags));
  if (!flags.figures.empty()) {
    TACTUS_RETURN_IF_ERROR(MakeFolder(flags.figures));
  }
  TACTUS_ASSIGN_OR_RETURN(const auto data, SimulateAll(flags, selection));
  Json rows = Json::array();
  int failed = 0;
  for (size_t i = 0; i < data.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(
        const int failed_here,
        RunExperiment(flags, selection, selection.experiments[i], data[i],
                      rows));
    failed += failed_here;
  }
  if (flags.json) {
    std::cout << JsonText(Json{{"rows", rows},
                               {"noise", NoiseOrDefault(flags.noise)},
                               {"seed", flags.seed},
                               {"seconds", SecondsSinceStart()}})
              << "\n";
  } else {
    std::cout << absl::StrFormat("noise %s, seed %d, %.1f s\n",
                                 NoiseOrDefault(flags.noise), flags.seed,
                                 SecondsSinceStart());
  }
  if (failed > 0) {
    return NumericalFailure(
        absl::StrCat(failed, " of ", rows.size(),
                     " rows could not be computed; each says why"));
  }
  return absl::OkStatus();
}

}  // namespace

void AddReproduce(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<ReproduceFlags>();
  CLI::App* command = &AddVerb(
      app, "reproduce",
      "Compute the paper's result tables and compare them with its figures",
      "reproduce --figures=paper-tables");
  command
      ->add_option("--only", flags->only,
                   "Algorithms: hmm, lstm, 1nn; default: all")
      ->delimiter(',');
  command
      ->add_option("--experiment", flags->experiments,
                   "simulation, cody; default: both")
      ->delimiter(',');
  command->add_option("--figures", flags->figures, "Folder for figures");
  command->add_option("--noise", flags->noise,
                      "Noise of the simulation's signals: relative or absolute "
                      "(trainctl simulate --help); default: relative");
  command->add_option("--seed", flags->seed, "Seed of noise and training");
  command->add_flag("--json", flags->json, "Print one JSON object on stdout");
  command->callback([=] { select([=] { return RunReproduce(*flags); }); });
}

}  // namespace tactus::internal::client
