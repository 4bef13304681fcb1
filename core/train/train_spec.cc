#include "core/train/train_spec.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/limits_training.h"
#include "core/base/status_macros.h"
#include "core/features/feature.h"
#include "core/questions/question_table.h"
#include "core/train/choose_cues.h"

namespace tactus::internal {
namespace {

// "force" -> "f", as ParseFeatures takes it.
absl::StatusOr<std::string> Letter(const std::string& feature) {
  if (feature == "force" || feature == "area" || feature == "motion") {
    return feature.substr(0, 1);
  }
  return InvalidConfig("features", feature, "force, area or motion");
}

absl::Status SetTruth(v1::Truth truth, FitOptions& options) {
  switch (truth) {
    case v1::TRUTH_UNSPECIFIED:
      return absl::OkStatus();
    case v1::TRUTH_FINAL:
      options.truth = Truth::kFinal;
      return absl::OkStatus();
    case v1::TRUTH_SO_FAR:
      options.truth = Truth::kSoFar;
      return absl::OkStatus();
    default:
      return InvalidConfig("truth", static_cast<int>(truth),
                           "TRUTH_FINAL or TRUTH_SO_FAR");
  }
}

absl::Status SetShares(v1::ClassShares shares, FitOptions& options) {
  switch (shares) {
    case v1::CLASS_SHARES_UNSPECIFIED:
    case v1::CLASS_SHARES_RECORDED:
      return absl::OkStatus();
    case v1::CLASS_SHARES_EVEN:
      options.shares = ClassShares::kEven;
      return absl::OkStatus();
    default:
      return InvalidConfig("shares", static_cast<int>(shares),
                           "CLASS_SHARES_RECORDED or CLASS_SHARES_EVEN");
  }
}

}  // namespace

absl::StatusOr<FitOptions> OptionsOf(const v1::TrainSpec& spec,
                                     absl::string_view preset) {
  TACTUS_ASSIGN_OR_RETURN(FitOptions options, FitPreset(preset));
  return ApplySpec(spec, std::move(options));
}

absl::StatusOr<FitOptions> ApplySpec(const v1::TrainSpec& spec,
                                     FitOptions options) {
  if (spec.features_size() > 0) {
    std::vector<std::string> letters;
    for (const std::string& feature : spec.features()) {
      TACTUS_ASSIGN_OR_RETURN(std::string letter, Letter(feature));
      letters.push_back(std::move(letter));
    }
    TACTUS_ASSIGN_OR_RETURN(options.features,
                            ParseFeatures(absl::StrJoin(letters, ",")));
  }
  if (spec.seed() != 0) options.seed = spec.seed();
  if (spec.has_networks()) {
    if (spec.networks() > limits::kMaxLstms) {
      return InvalidConfig("networks", spec.networks(),
                           absl::StrCat("0 to ", limits::kMaxLstms));
    }
    options.lstm.networks = static_cast<int>(spec.networks());
  }
  if (spec.has_epochs()) {
    if (spec.epochs() < 1 || spec.epochs() > limits::kMaxEpochs) {
      return InvalidConfig("epochs", spec.epochs(),
                           absl::StrCat("1 to ", limits::kMaxEpochs));
    }
    options.lstm.training.epochs = static_cast<int>(spec.epochs());
  }
  if (spec.has_gradient_shards()) {
    if (spec.gradient_shards() < 1 ||
        spec.gradient_shards() > limits::kMaxGradientShards) {
      return InvalidConfig("gradient_shards", spec.gradient_shards(),
                           absl::StrCat("1 to ", limits::kMaxGradientShards));
    }
    options.lstm.training.shards = static_cast<int>(spec.gradient_shards());
  }
  if (spec.has_hmms_per_class()) {
    if (spec.hmms_per_class() < 1 ||
        spec.hmms_per_class() > limits::kMaxHmmsPerClass) {
      return InvalidConfig("hmms_per_class", spec.hmms_per_class(),
                           absl::StrCat("1 to ", limits::kMaxHmmsPerClass));
    }
    options.hmms_per_class = static_cast<int>(spec.hmms_per_class());
  }
  if (!spec.questions().empty()) {
    TACTUS_ASSIGN_OR_RETURN(options.questions,
                            ParseQuestionTable(spec.questions()));
  }
  TACTUS_RETURN_IF_ERROR(SetTruth(spec.truth(), options));
  TACTUS_RETURN_IF_ERROR(SetShares(spec.shares(), options));
  TACTUS_RETURN_IF_ERROR(
      AddLstmCues("with_cues",
                  {spec.with_cues().begin(), spec.with_cues().end()}, options));
  TACTUS_RETURN_IF_ERROR(LeaveOutCues(
      "without_cues", {spec.without_cues().begin(), spec.without_cues().end()},
      options));
  return options;
}

absl::Status CheckOptions(const v1::TrainSpec& spec) {
  const bool chosen = spec.preset().empty() || spec.preset() == kAutoPreset;
  if (spec.choice_work() > limits::kMaxChoiceWork) {
    return InvalidConfig("choice_work", spec.choice_work(),
                         absl::StrCat("0 to ", limits::kMaxChoiceWork));
  }
  // What one preset's models take, another's may lack.
  if (chosen && spec.with_cues_size() + spec.without_cues_size() > 0) {
    return InvalidConfig("preset", kAutoPreset,
                         "named with with_cues or without_cues");
  }
  return OptionsOf(spec, chosen ? "tuned" : spec.preset()).status();
}

}  // namespace tactus::internal
