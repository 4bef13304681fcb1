// trainctl evaluate: how well the trials of a file are told apart.
#include "core/eval/evaluate.h"

#include <algorithm>
#include <filesystem>
#include <iostream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/tools/trainctl/command.h"
#include "client/tools/trainctl/evaluate_figures.h"
#include "client/tools/trainctl/fit_flags.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/eval/unknown.h"

namespace tactus::client {
namespace {

constexpr char kLeaveOneCategoryOut[] = "leave-one-category-out";

struct Flags {
  std::string data;
  std::string protocol;
  int folds = Protocol::kDefaultFolds;
  std::string model;
  std::string algorithm = "hmm";
  std::string layout;
  std::string figures;
  bool json = false;
  FitFlags fit;
};

std::string SecondsKey(double seconds) {
  return absl::StrFormat("%g", seconds);
}

Json ToJson(const EstimateErrors& errors) {
  return {{"contacts", errors.count},
          {"median_error", errors.median},
          {"rms_error", errors.root_mean_square},
          {"covered_by_deviation", errors.covered}};
}

// Null where nothing was estimated or the truth is not known.
Json ToJson(const std::vector<std::optional<EstimateOutcome>>& estimates) {
  std::vector<EstimateError> stiffness;
  std::vector<EstimateError> moved;
  for (const auto& e : estimates) {
    if (!e) continue;
    stiffness.push_back({e->said.log10_stiffness - e->log10_stiffness,
                         e->said.log10_stiffness_deviation});
    moved.push_back({e->said.moved_m - e->moved_m, e->said.moved_deviation_m});
  }
  if (stiffness.empty()) return nullptr;
  return {{"log10_stiffness", ToJson(SummariseErrors(stiffness))},
          {"moved_m", ToJson(SummariseErrors(moved))}};
}

// How many contacts were decided, how rightly and how soon.
Json ToJson(
    const std::vector<std::optional<Evaluation::DecisionOutcome>>& decisions) {
  std::vector<double> seconds;
  int right = 0;
  for (const auto& decision : decisions) {
    if (!decision) continue;
    seconds.push_back(decision->seconds);
    right += decision->right;
  }
  if (seconds.empty()) return nullptr;
  const auto middle =
      seconds.begin() + static_cast<ptrdiff_t>(seconds.size() / 2);
  std::nth_element(seconds.begin(), middle, seconds.end());
  const double count = static_cast<double>(seconds.size());
  return {{"decided", count / static_cast<double>(decisions.size())},
          {"accuracy", right / count},
          {"median_seconds", *middle}};
}

Json ToJson(const Flags& flags, const std::string& features,
            const LoadedContacts& loaded, const Evaluation& result) {
  Json accuracy_at = Json::object();
  Json ece_at = Json::object();
  Json parts = nullptr;
  for (int i = 0; i < kAnytimeCount; ++i) {
    const std::string key = SecondsKey(kAnytimeSeconds[i]);
    accuracy_at[key] = Accuracy(result.anytime[i]);
    ece_at[key] = ExpectedCalibrationError(result.anytime[i]);
    if (!result.anytime_hmm.empty()) {
      parts["hmm"][key] = Accuracy(result.anytime_hmm[i]);
      parts["lstm"][key] = Accuracy(result.anytime_lstm[i]);
    }
  }
  return {{"protocol", flags.model.empty() ? flags.protocol : "model"},
          {"algorithm", flags.algorithm},
          {"features", features},
          {"trials", loaded.trials},
          {"undetectable", loaded.undetectable},
          {"accuracy", Accuracy(result.final)},
          {"accuracy_at", accuracy_at},
          {"parts_accuracy_at", parts},
          {"classes", result.class_names},
          {"confusion",
           CountConfusion(result.final,
                          static_cast<int>(result.class_names.size()))},
          {"ece", ExpectedCalibrationError(result.final)},
          {"ece_at", ece_at},
          {"decision", ToJson(result.decisions)},
          {"estimate", ToJson(result.final_estimates)},
          {"estimate_at_1.2", ToJson(result.anytime_estimates[3])},
          {"seed", flags.fit.seed},
          {"seconds", SecondsSinceStart()}};
}

void PrintErrors(absl::string_view what, const Json& errors, double scale) {
  std::cout << absl::StrFormat(
      "Error of %s: median %.3f, rms %.3f; %s within the deviation said\n",
      what, scale * errors["median_error"].get<double>(),
      scale * errors["rms_error"].get<double>(),
      Percent(errors["covered_by_deviation"]));
}

void PrintForPeople(const Json& r) {
  std::cout << absl::StrFormat(
      "%s, %s, features %s: %s of %d trials (%d undetectable, not counted)\n",
      r["protocol"].get<std::string>(), r["algorithm"].get<std::string>(),
      r["features"].get<std::string>(), Percent(r["accuracy"]),
      r["trials"].get<int>(), r["undetectable"].get<int>());
  const Json& parts = r["parts_accuracy_at"];
  for (const auto& [seconds, accuracy] : r["accuracy_at"].items()) {
    std::cout << absl::StrFormat("  after %4s s  %s  calibration error %.3f",
                                 seconds, Percent(accuracy),
                                 r["ece_at"][seconds].get<double>());
    if (!parts.is_null()) {
      std::cout << absl::StrFormat("  (HMM alone %s, LSTM alone %s)",
                                   Percent(parts["hmm"][seconds]),
                                   Percent(parts["lstm"][seconds]));
    }
    std::cout << "\n";
  }
  std::cout << absl::StrFormat("Expected calibration error %.3f\n",
                               r["ece"].get<double>());
  if (const Json& d = r["decision"]; !d.is_null()) {
    std::cout << absl::StrFormat(
        "Decided %s, of these %s rightly, after %.2f s (median)\n",
        Percent(d["decided"]), Percent(d["accuracy"]),
        d["median_seconds"].get<double>());
  }
  if (const Json& e = r["estimate"]; !e.is_null()) {
    PrintErrors("log10 of stiffness (N/m)", e["log10_stiffness"], 1);
    PrintErrors("moved (mm)", e["moved_m"], 1000);
  }
  std::cout << "Rows are labels, columns answers:\n        ";
  for (const auto& name : r["classes"]) {
    std::cout << absl::StrFormat("%8s", name.get<std::string>());
  }
  std::cout << "\n";
  for (size_t i = 0; i < r["classes"].size(); ++i) {
    std::cout << absl::StrFormat("%8s", r["classes"][i].get<std::string>());
    for (const auto& count : r["confusion"][i]) {
      std::cout << absl::StrFormat("%8d", count.get<int>());
    }
    std::cout << "\n";
  }
  std::cout << absl::StrFormat("seed %d, %.1f s\n", r["seed"].get<int64_t>(),
                               r["seconds"].get<double>());
}

absl::Status Draw(const Flags& flags, const Evaluation& result) {
  std::filesystem::create_directories(flags.figures);
  const NamedEvaluation named{flags.algorithm, &result, 5};
  TACTUS_RETURN_IF_ERROR(DrawAnytime({named}, Experiment::kSimulation,
                                     flags.figures + "/anytime.png"));
  return DrawReliability({named}, flags.figures + "/reliability.png");
}

// How well contacts of a category left out are told to be unknown.
absl::Status RunUnknown(const Flags& flags) {
  TACTUS_ASSIGN_OR_RETURN(const FitOptions options, flags.fit.Options());
  TACTUS_ASSIGN_OR_RETURN(const LoadedContacts loaded,
                          LoadContacts(flags.data, flags.layout));
  TACTUS_ASSIGN_OR_RETURN(
      const auto results,
      EvaluateUnknown(loaded.Pointers(), options, RunOnThreads));
  Json categories = Json::array();
  for (const UnknownResult& r : results) {
    categories.push_back({{"category", r.category},
                          {"detected", r.detected},
                          {"false_alarms", r.false_alarms},
                          {"area_under_roc", r.area_under_roc}});
    if (flags.json) continue;
    std::cout << absl::StrFormat(
        "without %s: its contacts are unknown %s, others %s; area under the "
        "ROC curve %.3f\n",
        r.category, Percent(r.detected), Percent(r.false_alarms),
        r.area_under_roc);
  }
  if (flags.json) {
    std::cout << Json({{"protocol", flags.protocol},
                       {"seed", flags.fit.seed},
                       {"categories", categories},
                       {"seconds", SecondsSinceStart()}})
                     .dump()
              << "\n";
  } else {
    std::cout << absl::StrFormat("seed %d, %.1f s\n", flags.fit.seed,
                                 SecondsSinceStart());
  }
  return absl::OkStatus();
}

absl::Status Run(const Flags& flags) {
  if (flags.protocol.empty() == flags.model.empty()) {
    return InvalidConfig("--protocol and --model",
                         flags.model.empty() ? "both absent" : "both given",
                         "exactly one of the two");
  }
  if (flags.protocol == kLeaveOneCategoryOut) return RunUnknown(flags);
  TACTUS_ASSIGN_OR_RETURN(const Algorithm algorithm,
                          ParseAlgorithm(flags.algorithm));
  TACTUS_ASSIGN_OR_RETURN(const FitOptions options, flags.fit.Options());
  TACTUS_ASSIGN_OR_RETURN(const LoadedContacts loaded,
                          LoadContacts(flags.data, flags.layout));
  Evaluation result;
  std::string features;
  if (flags.model.empty()) {
    TACTUS_ASSIGN_OR_RETURN(const Protocol protocol,
                            ParseProtocol(flags.protocol, flags.folds));
    TACTUS_ASSIGN_OR_RETURN(
        result, EvaluateProtocol(loaded.Pointers(), protocol, algorithm,
                                 options, RunOnThreads));
    features = FeaturesToString(options.features);
  } else {
    TACTUS_ASSIGN_OR_RETURN(Model model, LoadModel(flags.model));
    TACTUS_ASSIGN_OR_RETURN(auto compiled,
                            CompiledModel::Create(std::move(model)));
    TACTUS_ASSIGN_OR_RETURN(result, EvaluateModel(compiled, loaded.Pointers(),
                                                  algorithm, RunOnThreads));
    features = FeaturesToString(FeaturesUsed(compiled->model().features));
  }
  if (!flags.figures.empty()) {
    TACTUS_RETURN_IF_ERROR(Draw(flags, result));
  }
  const Json json = ToJson(flags, features, loaded, result);
  if (flags.json) {
    std::cout << json.dump() << "\n";
  } else {
    PrintForPeople(json);
  }
  return absl::OkStatus();
}

}  // namespace

void AddEvaluate(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<Flags>();
  CLI::App* command = app.add_subcommand(
      "evaluate", "Measure accuracy by a protocol, or of a bundle");
  command->add_option("--data", flags->data, "Trial file")->required();
  command->add_option("--protocol", flags->protocol,
                      "loco, leave-one-out, leave-one-material-out, k-fold or, "
                      "for what is unknown, leave-one-category-out");
  command->add_option("--folds", flags->folds, "Folds of k-fold");
  command->add_option("--model", flags->model, "Bundle to evaluate instead");
  command->add_option("--algorithm", flags->algorithm,
                      "hmm, lstm, 1nn or fused");
  command->add_option("--layout", flags->layout,
                      "JSON file with the skin, for layouts without preset");
  command->add_option("--figures", flags->figures,
                      "Folder for figures of accuracy and reliability");
  command->add_flag("--json", flags->json, "One JSON object on stdout");
  flags->fit.Add(*command);
  command->callback([=] { select([=] { return Run(*flags); }); });
}

}  // namespace tactus::client
