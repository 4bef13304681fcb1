#include "core/sim/skin/record_contact.h"

#include <numbers>
#include <vector>

#include "core/features/contact_tracker.h"
#include "core/sim/skin/block_filter.h"
#include "core/sim/skin/record_contacts.h"

namespace tactus::internal {
namespace {

constexpr double kTiltDeviation = 0.5 * std::numbers::pi / 180;

}  // namespace

Placement DrawPlacement(const SkinLayout& layout, Random& random) {
  Placement placement;
  placement.centre.row = random.Uniform(0, layout.rows - 1);
  placement.centre.column = random.Uniform(
      0, layout.wrap_columns ? layout.columns : layout.columns - 1);
  placement.tilt_rad = kTiltDeviation * random.Gaussian();
  return placement;
}

Trial RecordContact(const SimulatedContact& contact, const SkinModel& skin,
                    const Placement& placement, Random& random) {
  const size_t lead_in = placement.lead_in_frames;
  const std::vector<FeatureVector>& samples = contact.signals.samples;
  const ContactScene scene = SceneOf(contact.spec);
  const Eigen::Vector3d normal = LinkNormal(skin.layout, placement.centre);
  LinkMotion motion;
  motion.pose_noise_m = placement.pose_noise_m;
  motion.pose_gain_error = placement.pose_gain_error;
  motion.steps.reserve(lead_in + samples.size());
  for (size_t i = 0; i < lead_in; ++i) {
    const double before_s = static_cast<double>(lead_in - 1 - i) / kSkinRateHz;
    motion.steps.push_back(
        {normal, ApproachPosition(contact.spec.approach_s, before_s, scene)});
  }
  for (const FeatureVector& sample : samples) {
    motion.steps.push_back(
        {normal, sample[static_cast<int>(Feature::kMotion)]});
  }
  const PlacedContact placed = {.contact = &contact,
                                .centre = placement.centre,
                                .tilt_rad = placement.tilt_rad,
                                .begin_frame = lead_in,
                                .end_sample = samples.size()};
  Trial trial =
      RecordContacts(contact.Metadata(), {&placed, 1}, skin, motion, random);
  trial.object_motion.assign(lead_in, 0);
  trial.object_motion.insert(trial.object_motion.end(),
                             contact.signals.object_motion.begin(),
                             contact.signals.object_motion.end());
  return trial;
}

bool Detectable(const Trial& trial, const SkinLayout& layout) {
  ContactTracker tracker(
      layout, {.sample_rate_hz = trial.sample_rate_hz, .load_profile = false});
  std::vector<float> frame(layout.taxels());
  for (size_t t = 0; t < trial.taxels.frames(); ++t) {
    trial.taxels.Decode(t, frame.data());
    tracker.Step({.taxels = frame});
    if (tracker.onset()) return true;
  }
  return false;
}

}  // namespace tactus::internal
