// File: trial_samples.h
//
// Small valid trials, for the tests of core/data.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/data/trial.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {

// A trial with every field set: signals, u16 (or f32) taxels and poses.
inline Trial FullTrial(uint64_t seed, int frames, bool floats = false) {
  Random random(seed);
  Trial trial;
  trial.taxels.rows = 3;
  trial.taxels.columns = 4;
  trial.taxels.scale = floats ? 1 : 0.5;
  for (int t = 0; t < frames; ++t) {
    trial.time.push_back(0.01 * t + 1e-4 * random.Uniform());
    trial.signals.push_back(
        {random.Uniform(), -random.Uniform(), 1e-300 * random.Gaussian()});
    for (int i = 0; i < 12; ++i) {
      const uint16_t value = static_cast<uint16_t>(random.Index(65536));
      if (floats) {
        trial.taxels.f32.push_back(static_cast<float>(random.Uniform()));
      } else {
        trial.taxels.u16.push_back(value);
      }
    }
    Pose pose;
    pose.position = {random.Uniform(), random.Uniform(), random.Uniform()};
    pose.orientation = Eigen::Quaterniond(random.Gaussian(), random.Gaussian(),
                                          random.Gaussian(), random.Gaussian())
                           .normalized();
    trial.poses.push_back(pose);
    trial.object_motion.push_back(1e-12 * random.Gaussian());
  }
  trial.source = "gr\xC3\xBCn 17.csv";
  trial.label = "SM";
  trial.condition = "k543-v0.005";
  trial.object = "cube 0.05 m, gr\xC3\xBCn";
  trial.material = "polymer foam";
  trial.stiffness = 1234.5678901234567;
  trial.velocity = 0.005;
  trial.sample_rate_hz = 99.5;
  trial.layout = "test-3x4";
  trial.unit = "counts";
  SkinLayout skin = {.name = "test-3x4",
                     .rows = 3,
                     .columns = 4,
                     .row_pitch_m = 0.1 / 3,
                     .column_pitch_m = 0.007,
                     .taxel_area_m2 = 1e-5 / 7,
                     .wrap_columns = true,
                     .unit = TaxelUnit::kCounts,
                     .contact_threshold = 1.0 / 3,
                     .onset_threshold = 2.0 / 3,
                     .connectivity = Connectivity::kFour,
                     .mask = std::vector<uint8_t>(12, 1)};
  skin.mask[5] = 0;
  trial.skin = skin;
  return trial;
}

// FullTrial with two touches that overlap: one with all that may be known of
// it, one with nothing but its label. `frames` >= 3.
inline Trial TrialOfTouches(uint64_t seed, int frames, bool floats = false) {
  Trial trial = FullTrial(seed, frames, floats);
  trial.object_motion.clear();
  Touch first;
  first.begin_s = trial.time[1];
  first.end_s = trial.time[frames - 1];
  first.label = trial.label;
  first.centre = {1.0 / 3, 2.7};
  first.object = "cube, gr\xC3\xBCn";
  first.material = "foam";
  first.stiffness = 1e5 / 3;
  for (int t = 1; t < frames; ++t) first.object_motion.push_back(1e-4 * t / 3);
  Touch second;
  second.begin_s = trial.time[1] + 1e-5;
  second.end_s = second.begin_s;
  second.label = "egg";
  trial.touches = {first, second};
  return trial;
}

// FullTrial on a skin of three signed axes; uint16 values have no sign.
inline Trial TrialOfAxes(uint64_t seed, int frames, v1::TaxelType type) {
  Trial trial =
      FullTrial(seed, frames, /*floats=*/type == v1::TAXEL_TYPE_FLOAT32);
  trial.skin->axes = trial.taxels.axes = 3;
  trial.skin->normal_axis = 2;
  trial.skin->signed_values = true;
  trial.taxels.u16.clear();
  trial.taxels.f32.clear();
  Random random(seed);
  for (int i = 0; i < 36 * frames; ++i) {
    const auto bits = static_cast<uint16_t>(random.Index(65536));
    if (type == v1::TAXEL_TYPE_UINT16) {
      trial.taxels.u16.push_back(bits);
    } else if (type == v1::TAXEL_TYPE_INT16) {
      trial.taxels.i16.push_back(static_cast<int16_t>(bits));
    } else {
      trial.taxels.f32.push_back(static_cast<float>(random.Gaussian()));
    }
  }
  return trial;
}

inline bool SameTouches(const std::vector<Touch>& a,
                        const std::vector<Touch>& b) {
  const auto same = [](const Touch& x, const Touch& y) {
    const auto centre = [](const Touch& t) {
      return std::vector<double>{t.centre ? t.centre->row : -1,
                                 t.centre ? t.centre->column : -1};
    };
    return x.begin_s == y.begin_s && x.end_s == y.end_s && x.label == y.label &&
           centre(x) == centre(y) && x.object == y.object &&
           x.material == y.material && x.stiffness == y.stiffness &&
           x.object_motion == y.object_motion;
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same);
}

// True if all numbers have the same bits and all texts are the same.
inline bool SameBits(const Trial& a, const Trial& b) {
  const auto poses = [](const Trial& t) {
    std::vector<double> values;
    for (const Pose& p : t.poses) {
      values.insert(values.end(), p.position.data(), p.position.data() + 3);
      values.insert(values.end(), p.orientation.coeffs().data(),
                    p.orientation.coeffs().data() + 4);
    }
    return values;
  };
  return a.id == b.id && a.source == b.source && a.time == b.time &&
         a.signals == b.signals && a.taxels.rows == b.taxels.rows &&
         a.taxels.columns == b.taxels.columns && a.taxels.u16 == b.taxels.u16 &&
         a.taxels.axes == b.taxels.axes && a.taxels.i16 == b.taxels.i16 &&
         a.taxels.f32 == b.taxels.f32 && a.taxels.scale == b.taxels.scale &&
         poses(a) == poses(b) && a.label == b.label &&
         a.condition == b.condition && a.object == b.object &&
         a.material == b.material && a.stiffness == b.stiffness &&
         a.object_motion == b.object_motion && a.velocity == b.velocity &&
         a.sample_rate_hz == b.sample_rate_hz && a.layout == b.layout &&
         a.unit == b.unit && a.skin == b.skin &&
         SameTouches(a.touches, b.touches);
}

}  // namespace tactus::internal
