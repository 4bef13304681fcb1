#include "core/data/frame_fingerprint.h"

#include <cstring>
#include <functional>
#include <set>

#include "core/base/sha256.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"

namespace tactus::internal {
namespace {

template <typename Number>
void Append(Number number, std::string& bytes) {
  char raw[sizeof number];
  std::memcpy(raw, &number, sizeof number);
  bytes.append(raw, sizeof raw);
}

TEST(FrameFingerprintTest, IsTheShaOfShapeTimesAndValues) {
  const Trial trial = FullTrial(1, 7);
  std::string bytes;
  for (const uint64_t number : {1, 7, 3, 4}) Append(number, bytes);
  for (const double time : trial.time) Append(time, bytes);
  for (const uint16_t value : trial.taxels.u16) {
    Append(static_cast<float>(value * trial.taxels.scale), bytes);
  }
  EXPECT_EQ(FrameFingerprint(trial), Sha256Hex(bytes));
}

TEST(FrameFingerprintTest, OnlyFramesMatter) {
  const Trial trial = FullTrial(2, 5);
  const std::function<void(Trial&)> same[] = {
      [](Trial& t) { t.id = "other"; },
      [](Trial& t) { t.source = "other.csv"; },
      [](Trial& t) { t.label = "HU"; },
      [](Trial& t) { t.condition = t.material = t.object = "x"; },
      [](Trial& t) { t.stiffness = t.velocity = 1; },
      [](Trial& t) { t.poses.clear(); },
      [](Trial& t) { t.object_motion.clear(); },
      [](Trial& t) { t.skin->onset_threshold *= 2; },
      // Signals beside taxels follow from them.
      [](Trial& t) { t.signals.clear(); },
      // The same values, as floats.
      [](Trial& t) {
        for (const uint16_t value : t.taxels.u16) {
          t.taxels.f32.push_back(static_cast<float>(value * t.taxels.scale));
        }
        t.taxels.u16.clear();
        t.taxels.scale = 1;
      }};
  for (size_t i = 0; i < std::size(same); ++i) {
    Trial changed = trial;
    same[i](changed);
    EXPECT_EQ(FrameFingerprint(changed), FrameFingerprint(trial)) << i;
  }
  const std::function<void(Trial&)> different[] = {
      [](Trial& t) { t.time[3] += 1e-9; },
      [](Trial& t) { t.taxels.u16[17] ^= 1; },
      [](Trial& t) { t.taxels.scale *= 2; },
      [](Trial& t) { std::swap(t.taxels.rows, t.taxels.columns); },
      [](Trial& t) {
        t.time.pop_back();
        t.taxels.u16.resize(t.taxels.u16.size() - 12);
      },
      [](Trial& t) { t.taxels = {}; }};
  std::set<std::string> fingerprints = {FrameFingerprint(trial)};
  for (size_t i = 0; i < std::size(different); ++i) {
    Trial changed = trial;
    different[i](changed);
    EXPECT_TRUE(fingerprints.insert(FrameFingerprint(changed)).second) << i;
  }
}

TEST(FrameFingerprintTest, FramesOfZerosIdentifyNothing) {
  Trial trial = FullTrial(3, 4);
  EXPECT_TRUE(IdentifiesRecording(FrameFingerprint(trial)));
  trial.taxels.u16.assign(trial.taxels.u16.size(), 0);
  EXPECT_FALSE(IdentifiesRecording(FrameFingerprint(trial)));
  EXPECT_EQ(FrameFingerprint(trial), std::string(64, '0'));
  EXPECT_FALSE(IdentifiesRecording(""));
}

TEST(FrameFingerprintTest, OfAllHasNoOrder) {
  EXPECT_EQ(FingerprintOfAll({"a", "b"}), FingerprintOfAll({"b", "a"}));
  EXPECT_EQ(FingerprintOfAll({"a", "b"}), Sha256Hex("a\nb\n"));
}

}  // namespace
}  // namespace tactus::internal
