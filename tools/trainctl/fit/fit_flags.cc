#include "tools/trainctl/fit/fit_flags.h"

#include <iostream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/train/choose_cues.h"
#include "core/train/train_spec.h"
#include "tools/trainctl/exit_code.h"
#include "tools/trainctl/fit/choice_text.h"

namespace tactus::internal::client {

void FitFlags::Add(CLI::App& command) {
  options_ = spec.Add(command);
  for (const CLI::Option* option :
       {command.add_option("--states", states,
                           "States per HMM, instead of the preset's"),
        command.add_flag("--no-estimates", no_estimates,
                         "Train no estimator of stiffness and motion"),
        command.add_flag("--skip-unusable", skip_unusable,
                         "Leave out what no model can be fitted to, instead of "
                         "refusing it: contacts that end before the models' "
                         "first step, have no label, or are too few of their "
                         "class"),
        command.add_option("--stretches", stretches,
                           "Stretches of each stretched cue, instead of the "
                           "preset's"),
        command.add_option("--hmm-cues", hmm_cues,
                           "Cues that the HMMs take as inputs, like "
                           "log_force,log_spring"),
        command.add_option("--lstm-cues", lstm_cues,
                           "Cues that the LSTMs take as inputs")}) {
    options_.push_back(option);
  }
}

std::string FitFlags::FirstGiven() const {
  for (const CLI::Option* option : options_) {
    if (option->count() > 0) return option->get_name();
  }
  return "";
}

namespace {

std::vector<std::string> Names(const std::string& flag) {
  if (flag.empty()) return {};
  return absl::StrSplit(flag, ',');
}

}  // namespace

OptionsRequest FitFlags::Request(bool without_poses) const {
  return {
      .preset = spec.preset,
      .without_poses = without_poses,
      .skip_unusable = skip_unusable,
      .networks_given = spec.networks.has_value(),
      .choice_work = spec.choice_work.value_or(kDefaultChoiceWork),
      .options_of = [this](absl::string_view name) { return Options(name); }};
}

absl::StatusOr<LoadedContacts> FitFlags::Load(const TrialSource& source,
                                              const Progress& progress) const {
  return ReadForFit(Request(false), [&](bool whole_skin) {
    return LoadContacts(source, progress, {.whole_skin = whole_skin});
  });
}

absl::StatusOr<ChosenOptions> FitFlags::Choose(
    const LoadedContacts& loaded, ProgressDisplay& display,
    const std::optional<Protocol>& protocol) const {
  OptionsRequest request = Request(loaded.without_poses);
  request.protocol = protocol;
  request.considered = [&](const ChoiceCandidate& candidate, int contacts) {
    display.Clear();
    std::cerr << CandidateLine(candidate, contacts) << "\n";
  };
  return ChooseOptions(loaded.Pointers(), request, RunOnThreads,
                       display.progress());
}

absl::StatusOr<FitOptions> FitFlags::Options(absl::string_view preset) const {
  auto known = FitPreset(preset);
  if (!known.ok()) return WithExitCode(known.status(), kExitUsage);
  FitOptions options = *std::move(known);
  if (states < 0 || states > limits::kMaxHmmStates) {
    return InvalidConfig("--states", states,
                         absl::StrCat("1 to ", limits::kMaxHmmStates));
  }
  if (states > 0) options.states = states;
  if (stretches && *stretches < 0) {
    return InvalidConfig("--stretches", *stretches, "0 or more");
  }
  if (stretches) options.lstm.stretches = *stretches;
  if (no_estimates) options.lstm.estimates = false;
  if (!hmm_cues.empty()) {
    TACTUS_ASSIGN_OR_RETURN(options.hmm_cues,
                            CuesNamed("--hmm-cues", Names(hmm_cues)));
  }
  if (!lstm_cues.empty()) {
    TACTUS_ASSIGN_OR_RETURN(options.lstm.cues,
                            CuesNamed("--lstm-cues", Names(lstm_cues)));
  }
  TACTUS_ASSIGN_OR_RETURN(const v1::TrainSpec wanted, TrainSpecOf(spec));
  TACTUS_ASSIGN_OR_RETURN(options, ApplySpec(wanted, std::move(options)));
  // A spec without a seed has the default one.
  options.seed = spec.seed;
  return options;
}

}  // namespace tactus::internal::client
