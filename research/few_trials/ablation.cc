// few-trials-ablation: what the parts of the learners for few trials are worth.
// One part at a time is left away or replaced, in the same outer folds.
//
//   few-trials-ablation fabric.h5 --protocol=loco
//
// Progress goes to stderr, a Markdown table to stdout. All of it is about the
// answers after the last frame. Sure answers are those with a probability of at
// least 0.95. The last column is the fraction of pairs of a right and a wrong
// answer in which the right one has the larger probability.
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "absl/strings/str_format.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/base/work.h"
#include "core/classify/compiled_model.h"
#include "core/contacts/class_counts.h"
#include "core/contacts/folds.h"
#include "core/contacts/labelled_contact.h"
#include "core/data/frame_fingerprint.h"
#include "core/data/trial_file.h"
#include "core/eval/evaluate.h"
#include "core/eval/metrics.h"
#include "core/eval/unknown.h"
#include "core/taxels/components.h"
#include "core/train/fit.h"

namespace tactus::internal {
namespace {

// One way to fit the models.
struct Variant {
  const char* name;
  const char* preset;
  InnerFolds inner_folds = InnerFolds::kChoice;
  // Contacts are fitted to without their group and condition, so that all inner
  // folds are stratified.
  bool stratified = false;
  bool holds = true;
  // Axes and signs are left out (core/taxels/components.h).
  bool loads_alone = false;
};

constexpr Variant kVariants[] = {
    {.name = "`pattern`, calibrated as before there was `ridge`",
     .preset = "pattern",
     .inner_folds = InnerFolds::kConditions},
    {.name = "`pattern`", .preset = "pattern"},
    {.name = "`ridge`, all inner folds stratified",
     .preset = "ridge",
     .stratified = true},
    {.name = "`ridge`", .preset = "ridge"},
    {.name = "`ridge`, answers never hold", .preset = "ridge", .holds = false},
    {.name = "`ridge`, loads alone", .preset = "ridge", .loads_alone = true},
    {.name = "`trees`", .preset = "trees"},
    {.name = "`nearest`", .preset = "nearest"},
};

struct AblationFlags {
  std::string data;
  std::string protocol;
  int folds = Protocol::kDefaultFolds;
  uint64_t seed = 1;
};

using Contacts = std::vector<LabelledContact>;
using Pointers = std::vector<const LabelledContact*>;

absl::StatusOr<Contacts> Load(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(auto reader, TrialFileReader::Open(path));
  Contacts contacts;
  for (size_t i = 0; i < reader.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(const Trial trial, reader.Read(i));
    TACTUS_ASSIGN_OR_RETURN(auto contact, ExtractContact(trial));
    if (!contact) continue;
    contact->fingerprint = FrameFingerprint(trial);
    contacts.push_back(*std::move(contact));
  }
  return contacts;
}

Contacts WithoutGroups(Contacts contacts) {
  for (LabelledContact& contact : contacts) {
    contact.material.clear();
    contact.condition.clear();
  }
  return contacts;
}

Contacts LoadsAlone(Contacts contacts) {
  for (LabelledContact& contact : contacts) {
    contact.layout.axes = 1;
    contact.layout.normal_axis.reset();
    contact.layout.signed_values = false;
  }
  return contacts;
}

Pointers Select(const Contacts& contacts, const std::vector<int>& indices) {
  Pointers selected;
  for (const int i : indices) selected.push_back(&contacts[i]);
  return selected;
}

absl::StatusOr<FitOptions> OptionsOf(const Variant& variant, Protocol protocol,
                                     uint64_t seed) {
  TACTUS_ASSIGN_OR_RETURN(FitOptions options, FitPreset(variant.preset));
  options.seed = seed;
  options.inner_folds = variant.inner_folds;
  // As EvaluateProtocol does.
  if (protocol.kind == Protocol::kLeaveOneMaterialOut &&
      options.inner_folds == InnerFolds::kConditions) {
    options.inner_folds = InnerFolds::kMaterials;
  }
  return options;
}

absl::StatusOr<Evaluation> Test(const Variant& variant,
                                const FitOptions& options,
                                const Pointers& training,
                                const Pointers& tests) {
  TACTUS_ASSIGN_OR_RETURN(Model model,
                          FitModel(training, options, RunSerially));
  if (!variant.holds) model.calibration.hold_after_frames = 0;
  TACTUS_ASSIGN_OR_RETURN(const auto compiled,
                          CompiledModel::Create(std::move(model)));
  return EvaluateModel(compiled, tests, Algorithm::kHmm, RunSerially);
}

// The answers in the end, and the probabilities of `unknown`, fold by fold.
struct Answers {
  std::vector<Outcome> outcomes;
  std::vector<double> unknown;
};

absl::StatusOr<Answers> TestAll(const Variant& variant,
                                const FitOptions& options,
                                const Contacts& fitted, const Contacts& tested,
                                const std::vector<std::vector<int>>& folds) {
  std::vector<absl::StatusOr<Evaluation>> results(folds.size());
  RunOnThreads(static_cast<int>(folds.size()), [&](int f) {
    const std::vector<int> rest =
        Complement(folds[f], static_cast<int>(fitted.size()));
    results[f] =
        Test(variant, options, Select(fitted, rest), Select(tested, folds[f]));
  });
  Answers all;
  for (const absl::StatusOr<Evaluation>& result : results) {
    TACTUS_RETURN_IF_ERROR(result.status());
    all.outcomes.insert(all.outcomes.end(), result->final.begin(),
                        result->final.end());
    all.unknown.insert(all.unknown.end(), result->unknown.begin(),
                       result->unknown.end());
  }
  return all;
}

void PrintHead(size_t contacts) {
  absl::PrintF(
      "| variant | right of %d, %% (95 %% interval) | calibration error "
      "| log loss | sure answers | right surer than wrong |\n"
      "|---|---|---|---|---|---|\n",
      contacts);
}

void PrintRow(const Variant& variant, const Answers& answers) {
  const std::vector<Outcome>& outcomes = answers.outcomes;
  const int count = static_cast<int>(outcomes.size());
  const Interval interval = WilsonInterval(CountRight(outcomes), count);
  const SureAnswers sure = CountSure(outcomes, answers.unknown, 0.95);
  const auto right = TopProbabilities(outcomes, true);
  const auto wrong = TopProbabilities(outcomes, false);
  const bool both = !right.empty() && !wrong.empty();
  absl::PrintF(
      "| %s | %.2f (%.2f to %.2f) | %.3f | %.3f | %d, %d right | %s |\n",
      variant.name, 100 * Accuracy(outcomes), 100 * interval.low,
      100 * interval.high, ExpectedCalibrationError(outcomes),
      MeanLogLoss(outcomes), sure.count, sure.right,
      both ? absl::StrFormat("%.2f", AreaUnderRoc(right, wrong)) : "-");
  std::fflush(stdout);
}

absl::Status Run(const AblationFlags& flags) {
  TACTUS_ASSIGN_OR_RETURN(const Protocol protocol,
                          ParseProtocol(flags.protocol, flags.folds));
  TACTUS_ASSIGN_OR_RETURN(const Contacts contacts, Load(flags.data));
  const Contacts without_groups = WithoutGroups(contacts);
  const Contacts loads_alone = LoadsAlone(contacts);
  const Pointers all =
      Select(contacts, Complement({}, static_cast<int>(contacts.size())));
  TACTUS_ASSIGN_OR_RETURN(const auto folds, MakeFolds(all, protocol));
  TACTUS_RETURN_IF_ERROR(CheckFolds(all, folds, protocol));
  PrintHead(contacts.size());
  const TaxelShape shape = ShapeOf(contacts.front().layout);
  const bool loads_are_all = shape == WithoutComponents(shape);
  for (const Variant& variant : kVariants) {
    if (variant.loads_alone && loads_are_all) continue;
    absl::FPrintF(stderr, "few-trials-ablation: %s\n", variant.name);
    TACTUS_ASSIGN_OR_RETURN(const FitOptions options,
                            OptionsOf(variant, protocol, flags.seed));
    TACTUS_ASSIGN_OR_RETURN(
        const Answers answers,
        TestAll(variant, options,
                variant.stratified    ? without_groups
                : variant.loads_alone ? loads_alone
                                      : contacts,
                variant.loads_alone ? loads_alone : contacts, folds));
    PrintRow(variant, answers);
  }
  return absl::OkStatus();
}

int Main(int argc, char** argv) {
  CLI::App app("What the parts of the learners for few trials are worth.",
               "few-trials-ablation");
  AblationFlags flags;
  app.add_option("trials", flags.data, "Trial file")->required();
  app.add_option("--protocol", flags.protocol,
                 "loco, leave-one-out, leave-one-material-out or k-fold")
      ->required();
  app.add_option("--folds", flags.folds, "Folds of k-fold")
      ->capture_default_str();
  app.add_option("--seed", flags.seed, "Seed of the fits")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const absl::Status status = Run(flags);
  if (status.ok()) return 0;
  absl::FPrintF(stderr, "few-trials-ablation: %s\n", status.ToString());
  return 1;
}

}  // namespace
}  // namespace tactus::internal

int main(int argc, char** argv) { return tactus::internal::Main(argc, argv); }
