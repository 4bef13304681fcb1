#include "core/train/variation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

namespace tactus {
namespace {

double Between(double before, double after, double fraction) {
  return before + fraction * (after - before);
}

ContactFrame Between(const ContactFrame& before, const ContactFrame& after,
                     double fraction) {
  ContactFrame frame = before;
  if (!before.touched || !after.touched) return frame;
  for (int f = 0; f < kFeatureCount; ++f) {
    frame.sample.features[f] =
        Between(before.sample.features[f], after.sample.features[f], fraction);
  }
  frame.sample.net_force =
      Between(before.sample.net_force, after.sample.net_force, fraction);
  return frame;
}

void AtPace(const LabelledContact& contact, double pace,
            LabelledContact& warped) {
  warped.id = contact.id;
  warped.label = contact.label;
  warped.condition = contact.condition;
  warped.material = contact.material;
  warped.sample_rate_hz = contact.sample_rate_hz;
  warped.stiffness = contact.stiffness;
  warped.layout = contact.layout;
  warped.frames.clear();
  warped.object_motion.clear();
  for (size_t k = 0; k < contact.frames.size(); ++k) {
    // The first frame is one frame after the touch.
    const double place = std::max(0.0, static_cast<double>(k + 1) * pace - 1);
    const auto before = static_cast<size_t>(place);
    if (before + 1 >= contact.frames.size()) break;
    const double fraction = place - static_cast<double>(before);
    warped.frames.push_back(
        Between(contact.frames[before], contact.frames[before + 1], fraction));
    if (contact.object_motion.empty()) continue;
    warped.object_motion.push_back(Between(contact.object_motion[before],
                                           contact.object_motion[before + 1],
                                           fraction));
  }
}

constexpr int kForceAt = static_cast<int>(Feature::kForce);
constexpr int kMotionAt = static_cast<int>(Feature::kMotion);

// The noise of one number of the samples, over a contact's touched frames.
template <typename Number>
double NoiseIn(const LabelledContact& contact, Number number) {
  std::vector<double> values;
  values.reserve(contact.frames.size());
  for (const ContactFrame& frame : contact.frames) {
    if (frame.touched) values.push_back(number(frame.sample));
  }
  return NoiseOf(values);
}

// The fraction of the noise that is missing after a signal was multiplied by
// `factor`.
double MissingNoise(double factor) {
  return std::sqrt(std::max(0.0, 1 - factor * factor));
}

}  // namespace

double NoiseOf(const std::vector<double>& values) {
  if (values.size() < 3) return 0;
  std::vector<double> bends;
  bends.reserve(values.size() - 2);
  for (size_t t = 2; t < values.size(); ++t) {
    bends.push_back(std::abs(values[t] - 2 * values[t - 1] + values[t - 2]));
  }
  const auto middle = bends.begin() + static_cast<long>(bends.size() / 2);
  std::nth_element(bends.begin(), middle, bends.end());
  return *middle / (0.6745 * std::sqrt(6.0));
}

LabelledContact Vary(const LabelledContact& contact, const Variation& variation,
                     Random& random) {
  LabelledContact varied;
  Vary(contact, variation, random, varied);
  return varied;
}

void Vary(const LabelledContact& contact, const Variation& variation,
          Random& random, LabelledContact& varied) {
  AtPace(contact, variation.pace, varied);
  const double load = variation.load;
  const double force = load * variation.stiffness;
  varied.stiffness *= variation.stiffness;
  if (load == 1 && force == 1) return;
  const double of_forces = MissingNoise(force);
  const double peak_noise = of_forces * NoiseIn(contact, [](auto& s) {
                              return s.features[kForceAt];
                            });
  const double net_noise =
      of_forces * NoiseIn(contact, [](auto& s) { return s.net_force; });
  const double motion_noise =
      MissingNoise(load) *
      NoiseIn(contact, [](auto& s) { return s.features[kMotionAt]; });
  for (ContactFrame& frame : varied.frames) {
    if (!frame.touched) continue;
    ContactSample& sample = frame.sample;
    // The largest taxel is part of the region: one draw serves both.
    const double of_force = random.Gaussian();
    double& peak = sample.features[kForceAt];
    peak = std::abs(force * peak + peak_noise * of_force);
    sample.net_force =
        std::abs(force * sample.net_force + net_noise * of_force);
    double& motion = sample.features[kMotionAt];
    motion = std::abs(load * motion + motion_noise * random.Gaussian());
  }
  for (double& moved : varied.object_motion) moved *= load;
}

}  // namespace tactus
