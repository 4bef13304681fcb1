#include "core/contacts/contact_set.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/skin/layout.h"

namespace tactus::internal {
namespace {

// As a stream's rate.
constexpr double kRateTolerance = 0.05;

absl::Status Check(const std::string& trial, const SkinLayout& layout,
                   double rate_hz, const Model& model) {
  const std::string difference = SkinMisfit(model, layout);
  if (!difference.empty()) {
    return InvalidConfig(absl::StrCat("skin of trial ", trial), difference,
                         "the skin that the model was fitted to");
  }
  const double model_rate = model.inputs.sample_rate_hz;
  if (std::abs(rate_hz / model_rate - 1) <= kRateTolerance) {
    return absl::OkStatus();
  }
  return InvalidConfig(absl::StrCat("sample_rate_hz of trial ", trial), rate_hz,
                       absl::StrCat("within 5 % of the model's ", model_rate));
}

}  // namespace

absl::Status CheckOneSkin(const LabelledContact& first,
                          const LabelledContact& contact) {
  const std::string difference = SkinDifference(contact.layout, first.layout);
  if (!difference.empty()) {
    return InvalidTrainingData(
        absl::StrCat("trial ", ContactName(contact), " has ", difference,
                     " as trial ", ContactName(first),
                     " has; trials that are used together have one skin"));
  }
  if (contact.sample_rate_hz != first.sample_rate_hz) {
    return InvalidTrainingData(
        absl::StrCat("trial ", ContactName(contact), " has sample_rate_hz ",
                     contact.sample_rate_hz, ", not ", first.sample_rate_hz,
                     " as trial ", ContactName(first),
                     " has; trials that are used together have one rate"));
  }
  return absl::OkStatus();
}

absl::Status CheckFits(const LabelledContact& contact, const Model& model) {
  const bool poses_fit = contact.with_poses ? model.poses != PoseNeed::kIgnored
                                            : model.poses != PoseNeed::kNeeded;
  if (!poses_fit) {
    return InvalidConfig(absl::StrCat("trial ", ContactName(contact)),
                         contact.with_poses ? "with poses" : "without poses",
                         contact.with_poses ? "without, as the model was fitted"
                                            : "with, as the model was fitted");
  }
  const SkinLayout& layout = IsIdeal(contact) ? model.layout : contact.layout;
  return Check(ContactName(contact), layout, contact.sample_rate_hz, model);
}

absl::Status CheckSkinOf(const Trial& trial, const SkinLayout& layout,
                         const Model& model) {
  return Check(TrialName(trial.id, trial.source), layout, trial.sample_rate_hz,
               model);
}

}  // namespace tactus::internal
