// trainctl fit: fits a model bundle to the trials of a file.
#include <iostream>
#include <mutex>

#include "absl/strings/str_format.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/base/version.h"
#include "core/bundle/bundle.h"
#include "core/files/draft_file.h"
#include "core/train/fit_journal.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/fit/choice_text.h"
#include "tools/trainctl/fit/fit_flags.h"
#include "tools/trainctl/fit/learning_curves.h"
#include "tools/trainctl/progress_display.h"

namespace tactus::internal::client {
namespace {

struct FitCommandFlags {
  std::string data;
  std::string out;
  std::string layout;
  std::string where;
  std::string note;
  double release_after_s = kDefaultReleaseAfterS;
  bool json = false;
  FitFlags fit;
};

// Shows the learning curves of a fit.
class FitCurves : public FitJournal {
 public:
  explicit FitCurves(ProgressDisplay* display) : display_(display) {}

  void OnPoint(const LearningPoint& point) override {
    std::lock_guard lock(mutex_);
    const auto loss = point.loss ? point.loss : point.validation_loss;
    const double value = loss ? *loss : point.log_likelihood.value_or(0);
    curves_.Add(point.part, value, !loss);
    display_->Curve(curves_.Text());
  }

 private:
  ProgressDisplay* const display_;
  std::mutex mutex_;
  LearningCurves curves_;
};

// Says, on standard error, what nobody can know of such a model.
void RemarkOneSession(const Provenance& provenance) {
  if (provenance.groups != 1 || provenance.conditions != 1) return;
  std::cerr << "trainctl: all trials are of one session, as far as they say: "
               "how well the model answers on another day, or to other "
               "objects, is not known. Record several, and give them a group "
               "or a condition each.\n";
}

absl::Status RunFit(const FitCommandFlags& flags) {
  // A bundle that cannot be written is found before the work, not after it.
  TACTUS_RETURN_IF_ERROR(DraftFile::Create(flags.out).status());
  ProgressDisplay display;
  TACTUS_ASSIGN_OR_RETURN(
      const LoadedContacts loaded,
      flags.fit.Load({flags.data, flags.layout, flags.where},
                     display.progress()));
  TACTUS_ASSIGN_OR_RETURN(const ChosenOptions chosen,
                          flags.fit.Choose(loaded, display));
  const FitOptions& options = chosen.options;
  FitCurves curves(&display);
  TACTUS_ASSIGN_OR_RETURN(
      Model model,
      FitModel(chosen.contacts, options, RunOnThreads, display.progress(),
               display.terminal() ? &curves : nullptr));
  display.Clear();
  RemarkCopies(chosen.contacts);
  model.release_after_s = flags.release_after_s;
  model.provenance.command = CommandLine();
  model.provenance.version = kVersion;
  model.provenance.data = flags.data;
  model.provenance.data_sha256 = loaded.data_sha256;
  model.provenance.note = flags.note;
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes, EncodeBundle(model));
  TACTUS_RETURN_IF_ERROR(WriteFileBytes(flags.out, bytes));
  RemarkOneSession(model.provenance);
  if (flags.json) {
    std::cout << JsonText(Json{{"bundle", flags.out},
                               {"sha256", BundleSha256(bytes)},
                               {"bytes", bytes.size()},
                               {"trials", loaded.trials},
                               {"undetectable", loaded.never_felt},
                               {"unusable", chosen.unusable},
                               {"classes", model.class_names},
                               {"features", FeaturesToString(options.features)},
                               {"preset", chosen.preset},
                               {"choice", ChoiceToJson(chosen.choice)},
                               {"seed", options.seed},
                               {"seconds", SecondsSinceStart()}})
              << "\n";
  } else {
    std::cout << ChoiceText(chosen.choice)
              << absl::StrFormat(
                     "%s: preset %s, %d bytes, %d trials, %d never felt, "
                     "%sseed %d, %.1f s\n"
                     "sha256 %s\n",
                     flags.out, chosen.preset, bytes.size(), loaded.trials,
                     loaded.never_felt,
                     chosen.unusable.empty()
                         ? ""
                         : absl::StrFormat("%d unusable, ",
                                           chosen.unusable.size()),
                     options.seed, SecondsSinceStart(), BundleSha256(bytes));
  }
  return absl::OkStatus();
}

}  // namespace

void AddFit(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<FitCommandFlags>();
  CLI::App* command =
      &AddVerb(app, "fit", "Fit a model bundle to the trials of a file",
               "fit --data=mine.h5 --preset=tuned --out=mine.tactus");
  command->add_option("--data", flags->data, "Trial file")->required();
  command->add_option("--out", flags->out, "Bundle to write")->required();
  command->add_option("--where", flags->where, kWhereHelp);
  command->add_option("--layout", flags->layout,
                      "JSON file with the skin of trials that carry none");
  command
      ->add_option("--release-after", flags->release_after_s,
                   "Seconds without touch that end a contact when the bundle "
                   "serves; -1: only the end of a trial ends it")
      ->capture_default_str();
  command->add_option("--note", flags->note, "Free text for the provenance");
  command->add_flag("--json", flags->json, "Print one JSON object on stdout");
  flags->fit.Add(*command);
  command->callback([=] { select([=] { return RunFit(*flags); }); });
}

}  // namespace tactus::internal::client
