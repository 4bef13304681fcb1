// File: three_axis_skin.h
//
// ThreeAxisSkin: a skin of three axes whose readings, in counts, answer to the
// loads along all axes, in newtons, by known matrices. Test-only.
//
//   ThreeAxisSkin skin({.noise = 2});
//   skin.newtons = [](int64_t frame, size_t taxel) { return AxisVector{}; };
//   const CrossAxis truth = skin.Truth(3);
//
// Not thread-safe.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "Eigen/Core"
#include "Eigen/LU"
#include "client/drivers/calibration/cross_axis.h"
#include "client/drivers/calibration/idle_frames.h"
#include "tests/client/drivers/calibration/synthetic_skin.h"

namespace tactus::internal::client::testing {

class ThreeAxisSkin : public SyntheticSkin {
 public:
  explicit ThreeAxisSkin(SyntheticShape shape) : SyntheticSkin(Three(shape)) {
    info.layout.unit = TaxelUnit::kNewton;
    Random random(77);
    const auto between = [&random](double least, double most) {
      return least + (most - least) * random.Uniform();
    };
    for (size_t i = 0; i < offset.size(); ++i) offset[i] = between(-300, 300);
    for (int taxel = 0; taxel < info.layout.taxels(); ++taxel) {
      Eigen::Matrix3d counts;
      // A fifth of cross-talk at most.
      for (int axis = 0; axis < 3; ++axis) {
        const double own = axis == 2 ? between(450, 600) : between(250, 350);
        for (int from = 0; from < 3; ++from) {
          counts(axis, from) = own * (axis == from ? 1 : between(-0.2, 0.2));
        }
      }
      counts_per_newton.push_back(counts);
    }
    load = [this](int64_t frame, size_t value) {
      const AxisVector newton = newtons(frame, value / 3);
      // Most frames are untouched.
      if (newton == AxisVector{}) return drift(frame);
      return drift(frame) + Reading(value / 3, newton)[value % 3];
    };
  }

  // Counts, of all values.
  std::function<double(int64_t frame)> drift = [](int64_t) { return 0.; };
  // Newtons along x, y and z.
  std::function<AxisVector(int64_t frame, size_t taxel)> newtons =
      [](int64_t, size_t) { return AxisVector{}; };
  std::vector<Eigen::Matrix3d> counts_per_newton;

  // Counts above the baseline at a load, without noise.
  AxisVector Reading(size_t taxel, const AxisVector& newton) const {
    const Eigen::Vector3d counts =
        counts_per_newton[taxel] *
        Eigen::Vector3d(newton[0], newton[1], newton[2]);
    return {counts[0], counts[1], counts[2]};
  }
  // The matrix that takes the cross-talk away.
  CrossAxis Truth(size_t taxel) const {
    const Eigen::Matrix3d inverse = counts_per_newton[taxel].inverse();
    CrossAxis truth;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) truth.rows[i][j] = inverse(i, j);
    }
    return truth;
  }
  CrossAxes Truths() const {
    CrossAxes truths;
    for (size_t i = 0; i < counts_per_newton.size(); ++i) {
      truths.emplace_back(Truth(i));
    }
    return truths;
  }
  // Loads within 1 N along the skin and 3 N into it, with what a taxel reads at
  // each, noise (counts) included.
  std::vector<KnownLoad> KnownLoads(size_t taxel, int lines, double noise,
                                    uint64_t seed) const {
    Random random(seed);
    std::vector<KnownLoad> known;
    for (int i = 0; i < lines; ++i) {
      KnownLoad line;
      line.load = {2 * random.Uniform() - 1, 2 * random.Uniform() - 1,
                   3 * random.Uniform()};
      line.reading = Reading(taxel, line.load);
      for (double& reading : line.reading) reading += noise * random.Gaussian();
      known.push_back(line);
    }
    return known;
  }

 private:
  static SyntheticShape Three(SyntheticShape shape) {
    shape.axes = 3;
    return shape;
  }
};

// The frames of an untouched skin, which is configured and activated.
inline IdleFrames ReadIdle(SkinDriver& skin, size_t frames) {
  const auto info = skin.Configure();
  IdleFrames idle(*info, frames);
  SkinFrame frame;
  if (!skin.Activate().ok()) return idle;
  while (!idle.complete()) {
    const auto result = skin.Read(frame);
    if (!result.ok() || *result == ReadResult::kEndOfData) break;
    if (*result == ReadResult::kFrame) idle.Add(frame);
  }
  return idle;
}

}  // namespace tactus::internal::client::testing
