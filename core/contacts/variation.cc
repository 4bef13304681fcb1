#include "core/contacts/variation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/gaussian.h"

namespace tactus::internal {
namespace {

double Between(double before, double after, double fraction) {
  return before + fraction * (after - before);
}

FeatureVector Between(const FeatureVector& before, const FeatureVector& after,
                      double fraction) {
  FeatureVector features;
  for (int f = 0; f < kFeatureCount; ++f) {
    features[f] = Between(before[f], after[f], fraction);
  }
  return features;
}

Shear Between(const Shear& before, const Shear& after, double fraction) {
  return {static_cast<float>(Between(before.first, after.first, fraction)),
          static_cast<float>(Between(before.second, after.second, fraction))};
}

ContactFrames::Numbers Between(const ContactFrames::Numbers& before,
                               const ContactFrames::Numbers& after,
                               double fraction) {
  if (!before.touched || !after.touched) return before;
  return {Between(before.features, after.features, fraction),
          Between(before.net_force, after.net_force, fraction), true,
          before.spread, Between(before.shear, after.shear, fraction)};
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
  const bool plain = contact.frames.plain();
  for (size_t k = 0; k < contact.frames.size(); ++k) {
    // The first frame is one frame after the touch.
    const double place = std::max(0.0, static_cast<double>(k + 1) * pace - 1);
    const auto before = static_cast<size_t>(place);
    if (before + 1 >= contact.frames.size()) break;
    const double fraction = place - static_cast<double>(before);
    const ContactFrames::Numbers numbers =
        Between(contact.frames.numbers(before),
                contact.frames.numbers(before + 1), fraction);
    if (plain) {
      warped.frames.push_back_numbers(numbers);
    } else {
      ContactFrame frame = contact.frames[before];
      frame.sample.features = numbers.features;
      frame.sample.net_force = numbers.net_force;
      frame.sample.shear = numbers.shear;
      warped.frames.push_back(frame);
    }
    if (contact.object_motion.empty()) continue;
    warped.object_motion.push_back(Between(contact.object_motion[before],
                                           contact.object_motion[before + 1],
                                           fraction));
  }
}

constexpr int kForceAt = static_cast<int>(Feature::kForce);
constexpr int kMotionAt = static_cast<int>(Feature::kMotion);

// The noise of one number of each frame, number(t), over a contact's touched
// frames.
template <typename Number>
double NoiseOfEach(const LabelledContact& contact, Number number) {
  std::vector<double> values;
  values.reserve(contact.frames.size());
  for (size_t t = 0; t < contact.frames.size(); ++t) {
    if (contact.frames.touched(t)) values.push_back(number(t));
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

ContactNoise NoiseIn(const LabelledContact& contact) {
  const ContactFrames& frames = contact.frames;
  const auto net = [&](size_t t) { return frames.net_force(t); };
  const auto force = [&](size_t t) { return frames.features(t)[kForceAt]; };
  const auto motion = [&](size_t t) { return frames.features(t)[kMotionAt]; };
  return {NoiseOfEach(contact, force), NoiseOfEach(contact, net),
          NoiseOfEach(contact, motion)};
}

LabelledContact Vary(const LabelledContact& contact, const Variation& variation,
                     Random& random) {
  LabelledContact varied;
  Vary(contact, NoiseIn(contact), variation, random, varied);
  return varied;
}

void Vary(const LabelledContact& contact, const ContactNoise& noise,
          const Variation& variation, Random& random, LabelledContact& varied) {
  AtPace(contact, variation.pace, varied);
  const double load = variation.load;
  const double force = load * variation.stiffness;
  varied.stiffness *= variation.stiffness;
  if (load == 1 && force == 1) return;
  const double peak_noise = MissingNoise(force) * noise.force;
  const double net_noise = MissingNoise(force) * noise.net_force;
  const double motion_noise = MissingNoise(load) * noise.motion;
  std::vector<double> deviates(2 * varied.frames.size());
  FillGaussian(random, deviates);
  const auto varied_force = [&](double value, double deviation, size_t t) {
    return std::abs(force * value + deviation * deviates[2 * t]);
  };
  for (size_t t = 0; t < varied.frames.size(); ++t) {
    if (!varied.frames.touched(t)) continue;
    ContactFrames::Numbers numbers = varied.frames.numbers(t);
    double& peak = numbers.features[kForceAt];
    double& motion = numbers.features[kMotionAt];
    // The largest taxel is part of the region: one draw serves both.
    peak = varied_force(peak, peak_noise, t);
    numbers.net_force = varied_force(numbers.net_force, net_noise, t);
    numbers.shear.first *= static_cast<float>(force);
    numbers.shear.second *= static_cast<float>(force);
    motion = load * motion + motion_noise * deviates[2 * t + 1];
    varied.frames.SetNumbers(t, numbers);
  }
  for (double& moved : varied.object_motion) moved *= load;
}

}  // namespace tactus::internal
