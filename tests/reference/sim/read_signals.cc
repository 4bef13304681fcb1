#include "tests/reference/sim/read_signals.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/sim/skin/block_filter.h"
#include "core/sim/skin/butterworth.h"

namespace tactus::internal {
namespace {

double UnclampedStrain(const Cube& cube, double force) {
  return force / cube.Stiffness() / cube.edge_m;
}

}  // namespace

IdealSignals ReadSignals(const Cube& cube, const Trajectory& trajectory,
                         bool with_area) {
  const double rate = trajectory.sample_rate_hz;
  const size_t stride = static_cast<size_t>(std::lround(rate / kSkinRateHz));
  const auto& raw = trajectory.samples;
  std::array<Butterworth6, 3> filters = {Butterworth6(kAntiAliasHz, rate),
                                         Butterworth6(kAntiAliasHz, rate),
                                         Butterworth6(kAntiAliasHz, rate)};
  IdealSignals signals;
  signals.samples.reserve(raw.size() / stride);
  signals.object_motion.reserve(raw.size() / stride);
  bool clamped = false;
  for (size_t i = 1; i < raw.size(); ++i) {
    const double force = (raw[i].impulse - raw[i - 1].impulse) * rate;
    // Share of the interval spent in contact.
    const double share = (raw[i].contact_time - raw[i - 1].contact_time) * rate;
    double area = 0;
    if (with_area && share > 0) {
      const double pressing = std::max(0.0, force / share);
      area = share * ContactArea(cube, pressing);
      clamped |= UnclampedStrain(cube, pressing) > kMaxStrain;
    }
    const FeatureVector sample = {filters[0].Step(force), filters[1].Step(area),
                                  filters[2].Step(raw[i].x_arm)};
    if (i % stride == 0) {
      signals.samples.push_back(sample);
      signals.object_motion.push_back(raw[i].x_uobj);
      signals.clamped += clamped;
      clamped = false;
    }
  }
  return signals;
}

}  // namespace tactus::internal
