#include "core/import/skin_folder_writer.h"

#include <cstring>
#include <filesystem>
#include <limits>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/files/file_bytes.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"
#include "tests/core/import/import_all.h"
#include "tests/support/flat_layout.h"

namespace tactus::internal {
namespace {

using testing::FlatLayout;
using ::testing::HasSubstr;

// Any positive float that a taxel may have, whatever its exponent.
float AnyFloat(Random& random) {
  while (true) {
    const auto bits = static_cast<uint32_t>(random.Index(0x53800000));
    float value = 0;
    std::memcpy(&value, &bits, sizeof value);
    if (value <= 1e12F) return value;
  }
}

// A trial of floats with texts that a table must quote.
Trial TrialOf(const SkinLayout& skin, uint64_t seed, int frames, bool poses) {
  Random random(seed);
  Trial trial;
  trial.id = "t" + std::to_string(seed);
  trial.label = "soft, \"moved\"";
  trial.condition = "k543; #1";
  trial.material = "gr\xC3\xBCn";
  trial.object = "1,5";
  trial.stiffness = 1e5 / 3;
  trial.velocity = 0.005;
  trial.sample_rate_hz = 100.0 / 1.01;
  trial.taxels.SetShape(skin);
  for (int t = 0; t < frames; ++t) {
    trial.time.push_back(0.01 * t + 1e-3 * random.Uniform());
    for (int i = 0; i < skin.values(); ++i) {
      float value = AnyFloat(random);
      if (skin.signed_values && random.Index(2) == 0) value = -value;
      if (!skin.mask.empty() && skin.mask[i / skin.axes] == 0) value = 0;
      trial.taxels.f32.push_back(value);
    }
    if (!poses) continue;
    Pose& pose = trial.poses.emplace_back();
    pose.position = {random.Gaussian(), -random.Uniform(), 1e-7};
    pose.orientation = Eigen::Quaterniond(random.Gaussian(), random.Gaussian(),
                                          random.Gaussian(), random.Gaussian())
                           .normalized();
  }
  SetSkin(skin, trial);
  return trial;
}

absl::Status Export(const std::string& folder,
                    const std::vector<Trial>& trials) {
  auto writer = SkinFolderWriter::Create(folder);
  if (!writer.ok()) return writer.status();
  for (const Trial& trial : trials) {
    const absl::Status status = writer->Append(trial);
    if (!status.ok()) return status;
  }
  return writer->Close();
}

void ExpectSameTrials(std::vector<Trial> trials) {
  const ScratchDir dir;
  const absl::Status status = Export(dir / "out", trials);
  ASSERT_TRUE(status.ok()) << status;
  std::vector<Trial> back;
  const auto count = ImportTrials(dir / "out", [&](Trial trial) {
    back.push_back(std::move(trial));
    return absl::OkStatus();
  });
  ASSERT_TRUE(count.ok()) << count.status();
  ASSERT_EQ(back.size(), trials.size());
  for (size_t i = 0; i < trials.size(); ++i) {
    // The source is the file that it was read from.
    trials[i].source = "frames/" + trials[i].id + ".csv";
    EXPECT_TRUE(SameBits(back[i], trials[i])) << trials[i].id;
  }
}

TEST(SkinFolderWriterTest, TheArmsSkinComesBackBitForBit) {
  SkinLayout skin = *LayoutPreset("cody-forearm");
  ASSERT_EQ(skin.values(), 384);
  ExpectSameTrials({TrialOf(skin, 1, 40, true), TrialOf(skin, 2, 30, false),
                    TrialOf(skin, 3, 1, true)});
  // A preset's name with other numbers stays another skin.
  skin.contact_threshold = skin.contact_threshold / 3;
  skin.connectivity = Connectivity::kFour;
  skin.wrap_columns = false;
  skin.taxel_area_m2 = 1e-5 / 7;
  skin.row_pitch_m = 0.01 / 3;
  ExpectSameTrials({TrialOf(skin, 4, 20, false)});
}

TEST(SkinFolderWriterTest, ThreeAxesComeBackBitForBit) {
  SkinLayout skin = FlatLayout("three", 16, 24, TaxelUnit::kCounts, 0.1, 0.3);
  skin.axes = 3;
  skin.signed_values = true;
  ExpectSameTrials({TrialOf(skin, 5, 20, true), TrialOf(skin, 6, 10, false)});
  skin.normal_axis = 2;
  ExpectSameTrials({TrialOf(skin, 7, 20, false)});
}

TEST(SkinFolderWriterTest, MaskLightTouchAndAuxiliaryTaxelsComeBack) {
  SkinLayout skin = FlatLayout("m", 3, 4, TaxelUnit::kCounts, 1, 2);
  skin.mask.assign(12, 1);
  ExpectSameTrials({TrialOf(skin, 8, 10, false)});
  skin.mask[0] = skin.mask[7] = 0;
  skin.light_touch = {.window_s = 0.1,
                      .rows = 2,
                      .columns = 3,
                      .contact_threshold = 0.1,
                      .onset_threshold = 1.0 / 3};
  ExpectSameTrials({TrialOf(skin, 9, 10, false)});
  // Two auxiliary taxels in the last row.
  skin.mask.assign(12, 1);
  std::fill(skin.mask.begin() + 8, skin.mask.end(), 0);
  skin.light_touch.reset();
  skin.signed_values = true;
  skin.normal_axis = 0;
  skin.auxiliary = {8, 9};
  Trial trial = TrialOf(skin, 10, 10, false);
  for (size_t t = 0; t < 10; ++t) {
    trial.taxels.f32[12 * t + 8] = -0.1F * static_cast<float>(t);
    trial.taxels.f32[12 * t + 9] = 1.0F / 3;
  }
  ExpectSameTrials({trial});
}

// Columns that look as if they had thousands or times in them.
TEST(SkinFolderWriterTest, ColumnsAreWhatTheyAre) {
  const SkinLayout skin = FlatLayout("s", 1, 2, TaxelUnit::kCounts, 1, 2);
  Trial trial = TrialOf(skin, 11, 20, false);
  for (size_t t = 0; t < 20; ++t) {
    trial.taxels.f32[2 * t] = static_cast<float>(t);
    trial.taxels.f32[2 * t + 1] = t == 3 ? 1.125F : 5;
  }
  ExpectSameTrials({trial});
}

// As a double, 7.038531e-26 lies in the middle of two floats, and rounding it
// again gives the wrong one.
TEST(SkinFolderWriterTest, FloatsThatAreRoundedTwiceComeBack) {
  const SkinLayout skin = FlatLayout("s", 1, 2, TaxelUnit::kCounts, 1, 2);
  Trial trial = TrialOf(skin, 17, 2, false);
  trial.taxels.f32[1] = 7.038531e-26F;
  ASSERT_NE(static_cast<float>(7.038531e-26), trial.taxels.f32[1]);
  ExpectSameTrials({trial});
}

TEST(SkinFolderWriterTest, IntegersComeBackAsTheirValues) {
  const ScratchDir dir;
  Trial trial = FullTrial(12, 20);
  trial.id = "a";
  trial.sample_rate_hz = 100;
  trial.taxels.scale = 0.1;
  ASSERT_TRUE(Export(dir / "out", {trial}).ok());
  const auto count = ImportTrials(dir / "out", [&](const Trial& back) {
    EXPECT_TRUE(back.taxels.u16.empty());
    for (size_t t = 0; t < 20; ++t) {
      for (size_t i = 0; i < 12; ++i) {
        const float want =
            static_cast<float>(0.1 * trial.taxels.u16[12 * t + i]);
        EXPECT_EQ(back.taxels.f32[12 * t + i], i == 5 ? 0 : want);
      }
    }
    EXPECT_EQ(back.skin, trial.skin);
    EXPECT_TRUE(back.signals.empty());
    return absl::OkStatus();
  });
  EXPECT_TRUE(count.ok()) << count.status();
}

TEST(SkinFolderWriterTest, WhatTheFolderCannotHoldIsRefused) {
  const SkinLayout skin = FlatLayout("s", 3, 4, TaxelUnit::kCounts, 1, 2);
  const Trial good = TrialOf(skin, 13, 5, false);
  struct Case {
    const char* text;
    void (*change)(Trial& trial);
  };
  const Case cases[] = {
      {"taxels: missing",
       [](Trial& t) {
         t.taxels = {};
         t.skin.reset();
         t.signals.resize(t.time.size());
       }},
      {"touches",
       [](Trial& t) {
         Touch& touch = t.touches.emplace_back();
         touch.label = t.label;
         touch.end_s = touch.begin_s = t.time[1];
       }},
      {"is not that of the first trial",
       [](Trial& t) { t.skin->contact_threshold = 0.5; }},
      {"label: is", [](Trial& t) { t.label = "HU "; }},
      {"material: is", [](Trial& t) { t.material = " foam"; }},
      {"id: ", [](Trial& t) { t.id = "a/b"; }},
      {"", [](Trial& t) { t.time[1] = t.time[0]; }},
  };
  for (const Case& c : cases) {
    const ScratchDir dir;
    Trial bad = good;
    bad.id = "bad";
    c.change(bad);
    const absl::Status status = Export(dir / "out", {good, bad});
    EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID") << c.text << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(c.text));
    EXPECT_FALSE(std::filesystem::exists(dir / "out/trials.csv"));
  }
  // Auxiliary taxels above others.
  const ScratchDir dir;
  SkinLayout other = skin;
  other.signed_values = true;
  other.normal_axis = 0;
  other.mask.assign(12, 1);
  other.mask[0] = 0;
  other.auxiliary = {0};
  const absl::Status status =
      Export(dir / "out", {TrialOf(other, 14, 5, false)});
  EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID") << status;
}

// Numbers of a line are bounded where files are read.
TEST(SkinFolderWriterTest, TooManyNumbersAreRefused) {
  const ScratchDir dir;
  SkinLayout skin = FlatLayout("s", 64, 64, TaxelUnit::kCounts, 1, 2);
  ExpectSameTrials({TrialOf(skin, 15, 2, true)});
  skin.axes = 3;
  skin.signed_values = true;
  const absl::Status status =
      Export(dir / "out", {TrialOf(skin, 16, 2, false)});
  EXPECT_THAT(std::string(status.message()), HasSubstr("export npz"));
}

}  // namespace
}  // namespace tactus::internal
