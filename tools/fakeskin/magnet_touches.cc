#include "tools/fakeskin/magnet_touches.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace tactus::internal::client {
namespace {

constexpr double kMagnetPitchM = 0.007;
// The part of the skin that the forearm is shrunk to reaches a little beyond
// the magnetometers.
constexpr double kSkinSideM = 0.016;
// Distance at which a force changes z by 0.61 of what it does at its place.
constexpr double kReachM = 0.006;
constexpr double kAway = 0.5;
// No field changes by more. Simulated contacts reach 40 N.
constexpr double kMostUt = 3'000;

}  // namespace

AnySkinBoard::Source MagnetSource(SimTouches& touches, double newton_per_ut) {
  constexpr size_t kValues = AnySkinBoard::kValues;
  const SkinLayout& layout = touches.patch().layout;
  // Microtesla for each newton on a taxel.
  std::vector<double> gains;
  for (int taxel = 0; taxel < layout.taxels(); ++taxel) {
    const double x_m =
        ((taxel % layout.columns + 0.5) / layout.columns - 0.5) * kSkinSideM;
    const double y_m =
        ((taxel / layout.columns + 0.5) / layout.rows - 0.5) * kSkinSideM;
    for (const auto& [column, row] : AnySkinBoard::kPlaces) {
      const double right = (column * kMagnetPitchM - x_m) / kReachM;
      const double up = (row * kMagnetPitchM - y_m) / kReachM;
      const double near = std::exp(-0.5 * (right * right + up * up));
      gains.push_back(kAway * right * near / newton_per_ut);
      gains.push_back(kAway * up * near / newton_per_ut);
      gains.push_back(-near / newton_per_ut);
    }
  }
  return [&touches, gains = std::move(gains),
          newtons = std::vector<double>(layout.taxels()),
          least = layout.contact_threshold](
             int64_t time_ns, std::span<double> field_ut) mutable {
    std::ranges::fill(newtons, 0.0);
    touches.ForcesAt(time_ns, 0, newtons);
    for (size_t taxel = 0; taxel < newtons.size(); ++taxel) {
      // What is below is noise of the simulated forearm.
      if (newtons[taxel] < least) continue;
      for (size_t i = 0; i < kValues; ++i) {
        field_ut[i] += gains[kValues * taxel + i] * newtons[taxel];
      }
    }
    for (size_t first = 0; first < kValues; first += 3) {
      const double size =
          std::hypot(field_ut[first], field_ut[first + 1], field_ut[first + 2]);
      for (size_t i = first; i < first + 3; ++i) {
        field_ut[i] *= kMostUt / (kMostUt + size);
      }
    }
  };
}

}  // namespace tactus::internal::client
