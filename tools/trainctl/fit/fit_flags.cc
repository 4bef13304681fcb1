#include "tools/trainctl/fit/fit_flags.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/train/choose_cues.h"
#include "tools/trainctl/exit_code.h"

namespace tactus::client {

void FitFlags::Add(CLI::App& command) {
  options_ = {
      command.add_option("--preset", preset,
                         "auto, tuned, world, paper, pattern, whole-skin or "
                         "profile; default: auto for a "
                         "skin without poses, else tuned"),
      command
          .add_option("--choice-work", choice_work,
                      "With preset auto: work that LSTMs may cost while "
                      "presets are compared, in billions of multiplications; "
                      "0 compares HMMs alone")
          ->capture_default_str()
          ->check(CLI::Range(0, static_cast<int>(limits::kMaxChoiceWork))),
      command.add_option("--features", features,
                         "Features that models may use: any of f (force), m "
                         "(motion), a (area), like f,m"),
      command.add_option("--truth", truth,
                         "What answers are about: final (the class in the "
                         "end) or so-far (unmoved until the object has moved), "
                         "instead of the preset's"),
      command.add_option("--shares", shares,
                         "Prior of the classes in calibrated answers: "
                         "recorded (as among the contacts of the fit) or even"),
      command.add_option("--seed", seed, "Seed of every random choice"),
      command.add_option("--states", states,
                         "States per HMM, instead of the preset's"),
      command.add_option("--hmms-per-class", mixtures,
                         "HMMs per class, instead of the preset's"),
      command.add_option(
          "--networks", networks,
          "Number of LSTMs, instead of the preset's; 0 for none"),
      command.add_option("--epochs", epochs,
                         "Epochs of LSTM training, instead of the preset's"),
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
                         "Cues that the LSTMs take as inputs"),
      command.add_option("--with-cues", with_cues,
                         "Cues that the LSTMs take beside the preset's, like "
                         "force_pitch_short"),
      command.add_option(
          "--without-cues", without_cues,
          "Cues that neither HMMs nor LSTMs take, like log_drag"),
  };
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
      .preset = preset,
      .without_poses = without_poses,
      .skip_unusable = skip_unusable,
      .networks_given = networks.has_value(),
      .choice_work = choice_work,
      .options_of = [this](absl::string_view name) { return Options(name); }};
}

absl::StatusOr<LoadedContacts> FitFlags::Load(const std::string& data,
                                              const std::string& layout,
                                              const Progress& progress) const {
  return ReadForFit(Request(false), [&](bool whole_skin) {
    return LoadContacts(data, layout, progress, {.whole_skin = whole_skin});
  });
}

absl::StatusOr<ChosenOptions> FitFlags::Choose(
    const LoadedContacts& loaded, const Progress& progress,
    const std::optional<Protocol>& protocol) const {
  OptionsRequest request = Request(loaded.without_poses);
  request.protocol = protocol;
  return ChooseOptions(loaded.Pointers(), request, RunOnThreads, progress);
}

absl::StatusOr<FitOptions> FitFlags::Options(absl::string_view preset) const {
  auto known = FitPreset(preset);
  if (!known.ok()) return WithExitCode(known.status(), kExitUsage);
  FitOptions options = *std::move(known);
  auto parsed = ParseFeatures(features);
  if (!parsed.ok()) return WithExitCode(parsed.status(), kExitUsage);
  options.features = *std::move(parsed);
  options.seed = seed;
  if (!truth.empty() && truth != "final" && truth != "so-far") {
    return WithExitCode(InvalidConfig("--truth", truth, "final or so-far"),
                        kExitUsage);
  }
  if (!truth.empty()) {
    options.truth = truth == "final" ? Truth::kFinal : Truth::kSoFar;
  }
  if (shares != "recorded" && shares != "even") {
    return WithExitCode(InvalidConfig("--shares", shares, "recorded or even"),
                        kExitUsage);
  }
  if (shares == "even") options.shares = ClassShares::kEven;
  if (states < 0 || states > limits::kMaxHmmStates) {
    return InvalidConfig("--states", states,
                         absl::StrCat("1 to ", limits::kMaxHmmStates));
  }
  if (mixtures < 0 || mixtures > limits::kMaxHmmsPerClass) {
    return InvalidConfig("--hmms-per-class", mixtures,
                         absl::StrCat("1 to ", limits::kMaxHmmsPerClass));
  }
  if (states > 0) options.states = states;
  if (mixtures > 0) options.hmms_per_class = mixtures;
  if (networks && (*networks < 0 || *networks > limits::kMaxLstms)) {
    return InvalidConfig("--networks", *networks,
                         absl::StrCat("0 to ", limits::kMaxLstms));
  }
  if (stretches && *stretches < 0) {
    return InvalidConfig("--stretches", *stretches, "0 or more");
  }
  if (epochs < 0) return InvalidConfig("--epochs", epochs, "1 or more");
  if (networks) options.lstm.networks = *networks;
  if (no_estimates) options.lstm.estimates = false;
  if (stretches) options.lstm.stretches = *stretches;
  if (epochs > 0) options.lstm.training.epochs = epochs;
  if (!hmm_cues.empty()) {
    TACTUS_ASSIGN_OR_RETURN(options.hmm_cues,
                            CuesNamed("--hmm-cues", Names(hmm_cues)));
  }
  if (!lstm_cues.empty()) {
    TACTUS_ASSIGN_OR_RETURN(options.lstm.cues,
                            CuesNamed("--lstm-cues", Names(lstm_cues)));
  }
  TACTUS_RETURN_IF_ERROR(AddLstmCues("--with-cues", Names(with_cues), options));
  TACTUS_RETURN_IF_ERROR(
      LeaveOutCues("--without-cues", Names(without_cues), options));
  return options;
}

}  // namespace tactus::client
