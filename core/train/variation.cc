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

LabelledContact AtPace(const LabelledContact& contact, double pace) {
  LabelledContact warped = contact;
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
  return warped;
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

// A range of stiffness, N/m.
struct Span {
  double min = 0;
  double max = std::numeric_limits<double>::infinity();
};

// The stiffnesses that keep a contact in its class, by class. Classes without
// an entry keep their stiffness; the result is empty if a stiffness is unknown.
// Soft and hard classes are those of VariationRange.
std::map<std::string, Span> SpansOf(
    const std::vector<const LabelledContact*>& contacts) {
  std::map<std::string, Span> seen;
  for (const LabelledContact* contact : contacts) {
    const double k = contact->stiffness;
    if (k <= 0) return {};
    Span& span = seen.try_emplace(contact->label, Span{k, k}).first->second;
    span.min = std::min(span.min, k);
    span.max = std::max(span.max, k);
  }
  std::map<std::string, Span> spans;
  for (const auto& [label, own] : seen) {
    bool soft = false;
    bool hard = false;
    for (const auto& [other, others] : seen) {
      soft |= own.max < others.min;
      hard |= own.min > others.max;
    }
    if (soft == hard) continue;
    spans[label] = soft ? Span{.max = own.max} : Span{.min = own.min};
  }
  return spans;
}

// Draws a factor on the stiffness, uniform in its logarithm, from the part of
// 1 / range to range that keeps the stiffness within `span`.
double DrawStiffness(double stiffness, const Span& span, double range,
                     Random& random) {
  const double low = std::max(1 / range, span.min / stiffness);
  const double high = std::min(range, span.max / stiffness);
  return low * std::pow(high / low, random.Uniform());
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
  LabelledContact varied = AtPace(contact, variation.pace);
  const double load = variation.load;
  const double force = load * variation.stiffness;
  varied.stiffness *= variation.stiffness;
  if (load == 1 && force == 1) return varied;
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
  return varied;
}

std::vector<LabelledContact> DrawVariations(
    const std::vector<const LabelledContact*>& contacts,
    const VariationRange& range, uint64_t seed) {
  std::vector<LabelledContact> drawn;
  drawn.reserve(contacts.size() * static_cast<size_t>(range.copies));
  const auto spans = SpansOf(contacts);
  for (int copy = 0; copy < range.copies; ++copy) {
    for (size_t i = 0; i < contacts.size(); ++i) {
      Random random = Random::ForStream(seed, copy * contacts.size() + i);
      const double pace = std::pow(range.pace, random.Uniform(-1, 1));
      const double load = std::pow(range.load, random.Uniform(-1, 0));
      double stiffness = 1;
      const auto span = spans.find(contacts[i]->label);
      if (copy % 2 == 1 && range.stiffness > 1 && span != spans.end()) {
        stiffness = DrawStiffness(contacts[i]->stiffness, span->second,
                                  range.stiffness, random);
      }
      drawn.push_back(Vary(*contacts[i], {pace, load, stiffness}, random));
    }
  }
  return drawn;
}

}  // namespace tactus
