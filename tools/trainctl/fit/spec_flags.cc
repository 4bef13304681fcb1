#include "tools/trainctl/fit/spec_flags.h"

#include <map>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/limits_questions.h"
#include "core/base/limits_training.h"
#include "core/base/status_macros.h"
#include "core/eval/auto_preset.h"
#include "core/features/feature.h"
#include "core/files/file_bytes.h"
#include "core/questions/question_table.h"
#include "tools/trainctl/exit_code.h"

namespace tactus::internal::client {
namespace {

const std::map<std::string, v1::Truth> kTruths = {{"", v1::TRUTH_UNSPECIFIED},
                                                  {"final", v1::TRUTH_FINAL},
                                                  {"so-far", v1::TRUTH_SO_FAR}};

const std::map<std::string, v1::ClassShares> kShares = {
    {"", v1::CLASS_SHARES_UNSPECIFIED},
    {"recorded", v1::CLASS_SHARES_RECORDED},
    {"even", v1::CLASS_SHARES_EVEN}};

// What `text` is called on the wire.
template <typename Value>
absl::StatusOr<Value> Named(const std::map<std::string, Value>& values,
                            const char* flag, const std::string& text,
                            const char* want) {
  const auto found = values.find(text);
  if (found != values.end()) return found->second;
  return WithExitCode(InvalidConfig(flag, text, want), kExitUsage);
}

// Calls `set` with the number, if there is one, for a field of the spec.
template <typename Set>
absl::Status SetCount(const char* flag, const std::optional<int>& count,
                      int64_t least, int64_t most, Set set) {
  if (!count) return absl::OkStatus();
  if (*count < least || *count > most) {
    return WithExitCode(
        InvalidConfig(flag, *count, absl::StrCat(least, " to ", most)),
        kExitUsage);
  }
  set(static_cast<uint32_t>(*count));
  return absl::OkStatus();
}

}  // namespace

std::vector<const CLI::Option*> SpecFlags::Add(CLI::App& command) {
  return {
      command.add_option("--preset", preset,
                         "auto, tuned, world, paper, pattern, ridge, trees, "
                         "nearest, whole-skin or "
                         "profile; default: auto for a skin without poses, "
                         "else tuned"),
      command.add_option(
          "--choice-work", choice_work,
          absl::StrCat("With preset auto: work that LSTMs may cost while "
                       "presets are compared, in billions of "
                       "multiplications; 0 compares HMMs alone; default: ",
                       kDefaultChoiceWork)),
      command.add_option("--features", features,
                         "Features that models may use: any of f (force), m "
                         "(motion), a (area), like f,m"),
      command.add_option("--truth", truth,
                         "What answers are about: final (the class in the "
                         "end) or so-far (unmoved until the object has moved), "
                         "instead of the preset's"),
      command.add_option("--shares", shares,
                         "Prior of the classes in calibrated answers: "
                         "recorded (as among the contacts of the fit; the "
                         "default) or even"),
      command.add_option("--seed", seed, "Seed of every random choice")
          ->capture_default_str(),
      command.add_option(
          "--networks", networks,
          "Number of LSTMs, instead of the preset's; 0 for none"),
      command.add_option("--epochs", epochs,
                         "Epochs of LSTM training, instead of the preset's"),
      command.add_option("--gradient-shards", gradient_shards,
                         "Shards of each batch of LSTM training; several "
                         "ranks train a network of several shards together; "
                         "default: 1"),
      command.add_option("--hmms-per-class", hmms_per_class,
                         "HMMs per class, instead of the preset's"),
      command.add_option("--with-cues", with_cues,
                         "Cues that the LSTMs take beside the preset's, like "
                         "force_pitch_short"),
      command.add_option(
          "--without-cues", without_cues,
          "Cues that neither HMMs nor LSTMs take, like log_drag"),
      command.add_option("--questions", questions,
                         "CSV file with what each class answers to each "
                         "question, like class,hardness,mobility:state; "
                         "default: as the names of the classes say"),
  };
}

absl::StatusOr<v1::TrainSpec> TrainSpecOf(const SpecFlags& flags) {
  v1::TrainSpec spec;
  spec.set_preset(flags.preset);
  if (!flags.features.empty()) {
    const auto features = ParseFeatures(flags.features);
    if (!features.ok()) return WithExitCode(features.status(), kExitUsage);
    for (const Feature feature : *features) {
      spec.add_features(std::string(FeatureName(feature)));
    }
  }
  TACTUS_ASSIGN_OR_RETURN(
      const v1::Truth truth,
      Named(kTruths, "--truth", flags.truth, "final or so-far"));
  spec.set_truth(truth);
  TACTUS_ASSIGN_OR_RETURN(
      const v1::ClassShares shares,
      Named(kShares, "--shares", flags.shares, "recorded or even"));
  spec.set_shares(shares);
  spec.set_seed(flags.seed);
  TACTUS_RETURN_IF_ERROR(
      SetCount("--networks", flags.networks, 0, limits::kMaxLstms,
               [&](uint32_t count) { spec.set_networks(count); }));
  TACTUS_RETURN_IF_ERROR(
      SetCount("--epochs", flags.epochs, 1, limits::kMaxEpochs,
               [&](uint32_t count) { spec.set_epochs(count); }));
  TACTUS_RETURN_IF_ERROR(SetCount(
      "--gradient-shards", flags.gradient_shards, 1, limits::kMaxGradientShards,
      [&](uint32_t count) { spec.set_gradient_shards(count); }));
  TACTUS_RETURN_IF_ERROR(SetCount(
      "--hmms-per-class", flags.hmms_per_class, 1, limits::kMaxHmmsPerClass,
      [&](uint32_t count) { spec.set_hmms_per_class(count); }));
  TACTUS_RETURN_IF_ERROR(
      SetCount("--choice-work", flags.choice_work, 0, limits::kMaxChoiceWork,
               [&](uint32_t count) { spec.set_choice_work(count); }));
  if (!flags.with_cues.empty()) {
    for (const auto cue : absl::StrSplit(flags.with_cues, ',')) {
      spec.add_with_cues(std::string(cue));
    }
  }
  if (!flags.without_cues.empty()) {
    for (const auto cue : absl::StrSplit(flags.without_cues, ',')) {
      spec.add_without_cues(std::string(cue));
    }
  }
  if (!flags.questions.empty()) {
    TACTUS_ASSIGN_OR_RETURN(
        *spec.mutable_questions(),
        ReadFileBytes(flags.questions, limits::kMaxQuestionTableBytes));
    TACTUS_RETURN_IF_ERROR(Annotate(
        ParseQuestionTable(spec.questions()).status(), flags.questions));
  }
  return spec;
}

}  // namespace tactus::internal::client
