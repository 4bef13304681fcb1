#include "core/contacts/labelled_contact.h"

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/data/trial_layout.h"
#include "core/features/contact_tracker.h"

namespace tactus::internal {
namespace {

void TakeTaxels(const Trial& trial, const SkinLayout& layout,
                const ExtractOptions& options, LabelledContact& contact) {
  ContactTracker tracker(layout, {.sample_rate_hz = trial.sample_rate_hz,
                                  .release_after_s = options.release_after_s,
                                  .load_profile = options.whole_skin,
                                  .taxel_loads = options.whole_skin,
                                  .taxel_components = true,
                                  .load_spread = true,
                                  .shear = true});
  std::vector<float> taxels(layout.values());
  for (size_t t = 0; t < trial.taxels.frames(); ++t) {
    trial.taxels.Decode(t, taxels.data());
    FrameView frame{.taxels = taxels};
    if (!trial.poses.empty()) frame.pose = &trial.poses[t];
    const FrameFeatures& features = tracker.Step(frame);
    if (tracker.onset()) {
      contact.frames.clear();
      contact.object_motion.clear();
    }
    if (tracker.state() == ContactState::kInContact) {
      contact.frames.push_back({features.sample(), features.touched});
      if (!trial.object_motion.empty()) {
        contact.object_motion.push_back(trial.object_motion[t]);
      }
    }
  }
}

}  // namespace

ContactSample IdealSample(const FeatureVector& signals) {
  return {signals, signals[static_cast<int>(Feature::kForce)]};
}

std::string LabelAtRest(const std::string& label) {
  if (label == "HM") return "HU";
  return label == "SM" ? "SU" : label;
}

std::string LabelSoFar(const LabelledContact& contact, size_t frame) {
  const std::vector<double>& motion = contact.object_motion;
  if (motion.empty() || motion[frame] > kMovedM) return contact.label;
  return LabelAtRest(contact.label);
}

absl::StatusOr<std::optional<LabelledContact>> ExtractContact(
    const Trial& trial, const ExtractOptions& options) {
  if (trial.touches.size() > 1) {
    return InvalidTrainingData(absl::StrCat(
        "trial ", trial.id, " has ", trial.touches.size(),
        " touches; models are fitted to and evaluated on trials of one "
        "contact. Cut it into one trial for each touch"));
  }
  LabelledContact contact;
  contact.id = trial.id;
  contact.source = trial.source;
  contact.label = trial.label;
  contact.condition = trial.condition;
  contact.material = trial.material;
  contact.sample_rate_hz = trial.sample_rate_hz;
  contact.stiffness = trial.stiffness;
  if (trial.taxels.empty()) {
    for (const FeatureVector& signals : trial.signals) {
      contact.frames.push_back({IdealSample(signals), true});
    }
    contact.object_motion = trial.object_motion;
  } else {
    contact.with_poses = !trial.poses.empty();
    TACTUS_ASSIGN_OR_RETURN(contact.layout,
                            LayoutOfTrial(trial, options.layout));
    TakeTaxels(trial, contact.layout, options, contact);
  }
  contact.frames.shrink_to_fit();
  contact.object_motion.shrink_to_fit();
  if (contact.frames.empty()) return std::optional<LabelledContact>();
  return std::optional<LabelledContact>(std::move(contact));
}

}  // namespace tactus::internal
