// File: trial_samples.h
//
// Small valid trials and a folder that cleans up after itself, for the tests
// of core/data.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "core/base/random.h"
#include "core/data/trial.h"
#include "gtest/gtest.h"

namespace tactus {

// A separate folder for the running test, removed at the end.
class ScratchDir {
 public:
  ScratchDir() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name =
        std::string(info->test_suite_name()) + "." + info->name();
    for (char& c : name) {
      if (c == '/') c = '_';
    }
    path_ = std::filesystem::path(::testing::TempDir()) /
            ("tactus-" + name + "-" + std::to_string(getpid()));
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~ScratchDir() { std::filesystem::remove_all(path_); }
  ScratchDir(const ScratchDir&) = delete;
  ScratchDir& operator=(const ScratchDir&) = delete;

  std::string operator/(const std::string& name) const { return path_ / name; }
  std::string path() const { return path_; }
  size_t files() const {
    return std::distance(std::filesystem::directory_iterator(path_), {});
  }

 private:
  std::filesystem::path path_;
};

inline std::string ReadBytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void WriteBytes(const std::string& path, const std::string& bytes) {
  // Truncating an existing file makes some file systems flush it to disk.
  std::filesystem::remove(path);
  std::ofstream(path, std::ios::binary) << bytes;
}

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
  return a.id == b.id && a.time == b.time && a.signals == b.signals &&
         a.taxels.rows == b.taxels.rows &&
         a.taxels.columns == b.taxels.columns && a.taxels.u16 == b.taxels.u16 &&
         a.taxels.f32 == b.taxels.f32 && a.taxels.scale == b.taxels.scale &&
         poses(a) == poses(b) && a.label == b.label &&
         a.condition == b.condition && a.object == b.object &&
         a.material == b.material && a.stiffness == b.stiffness &&
         a.object_motion == b.object_motion && a.velocity == b.velocity &&
         a.sample_rate_hz == b.sample_rate_hz && a.layout == b.layout &&
         a.unit == b.unit && a.skin == b.skin;
}

}  // namespace tactus
