#include "core/data/trial_npz.h"

#include "core/base/errors.h"
#include "core/data/trial_csv.h"
#include "core/data/trial_zarr.h"
#include "core/files/npy_write.h"
#include "core/files/npz.h"
#include "core/files/zarr.h"
#include "core/import/import.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"

namespace tactus::internal {
namespace {

using testing::HasSubstr;

TEST(TrialNpzTest, EveryFieldComesBackBitForBit) {
  for (const bool floats : {false, true}) {
    const Trial trial = FullTrial(3, 17, floats);
    const auto bytes = TrialToNpz(trial);
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    EXPECT_EQ(*bytes, *TrialToNpz(trial));
    auto back = TrialFromNpz("x.npz", *bytes);
    ASSERT_TRUE(back.ok()) << back.status();
    EXPECT_TRUE(SameBits(trial, *back));
  }
}

TEST(TrialNpzTest, TouchesComeBackBitForBit) {
  const Trial trial = TrialOfTouches(3, 17);
  const auto bytes = TrialToNpz(trial);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  auto back = TrialFromNpz("x.npz", *bytes);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_TRUE(SameBits(trial, *back));
  // By the names that docs/formats.md gives them.
  const auto arrays = ParseNpz("x.npz", *bytes);
  ASSERT_TRUE(arrays.ok()) << arrays.status();
  EXPECT_EQ(arrays->at("touches/01/label").text.front(), "egg");
  EXPECT_EQ(arrays->at("touches/00/row").f64.front(), 1.0 / 3);
  EXPECT_FALSE(arrays->contains("touches/01/row"));
}

// What somebody writes by hand: no more than is needed, other number types.
TEST(TrialNpzTest, TheLeastIsRead) {
  const std::vector<double> time = {0, 0.01};
  const std::vector<float> signals = {1, 2, 3, 4, 5, 6};
  auto trial = TrialFromNpz(
      "x.npz",
      *NpzBytes({{"time", NpyBytes({2}, std::span<const double>(time))},
                 {"signals", NpyBytes({2, 3}, std::span<const float>(signals))},
                 {"label", NpyText("HU")}}));
  ASSERT_TRUE(trial.ok()) << trial.status();
  EXPECT_EQ(trial->signals[1], (FeatureVector{4, 5, 6}));
  EXPECT_EQ(trial->label, "HU");
  EXPECT_EQ(trial->sample_rate_hz, 100);
}

TEST(TrialNpzTest, EachMistakeIsNamed) {
  const std::vector<double> two = {0, 1};
  const std::vector<double> six = {0, 1, 2, 3, 4, 5};
  const std::vector<uint16_t> words = {1, 2};
  const std::string time = NpyBytes({2}, std::span<const double>(two));
  const std::string signals = NpyBytes({2, 3}, std::span<const double>(six));
  struct Case {
    std::vector<std::pair<std::string, std::string>> arrays;
    const char* text;
  };
  const Case cases[] = {
      {{{"signals", signals}}, "no array time"},
      {{{"time", time}}, "signals: missing, and so are taxels"},
      {{{"time", time},
        {"signals", NpyBytes({3, 2}, std::span<const double>(six))}},
       "array signals has shape (3, 2); it must be (2, 3)"},
      {{{"time", time}, {"signals", signals}, {"labels", NpyText("HU")}},
       "array labels is of no use"},
      {{{"time", time}, {"signals", signals}, {"label", time}},
       "array label has shape (2)"},
      {{{"time", time}, {"signals", signals}, {"stiffness", NpyText("hard")}},
       "array stiffness must be floating-point"},
      {{{"time", time},
        {"taxels", NpyBytes({2, 1, 1}, std::span<const double>(two))}},
       "array taxels must be uint16, int16 or float32"},
      {{{"time", time}, {"signals", signals}, {"skin", NpyText("{")}},
       "array skin "},
      {{{"time", time},
        {"taxels", NpyBytes({2, 1, 1}, std::span<const uint16_t>(words))},
        {"taxel_scale", NpyBytes({}, std::span<const double>(&six[0], 1))}},
       "scale is 0"},
      {{{"time", NpyBytes({2}, std::span<const double>(&six[1], 1))}},
       "bytes of values"},
  };
  for (const Case& c : cases) {
    const auto trial = TrialFromNpz("x.npz", *NpzBytes(c.arrays));
    EXPECT_EQ(ReasonOf(trial.status()), "TRIAL_FILE_INVALID");
    EXPECT_THAT(std::string(trial.status().message()), HasSubstr(c.text));
    EXPECT_THAT(std::string(trial.status().message()), HasSubstr("x.npz"));
  }
}

TEST(TrialNpzTest, ImportTakesFoldersOfThem) {
  const ScratchDir dir;
  const Trial trial = FullTrial(4, 5);
  WriteBytes(dir / "seven.npz", *TrialToNpz(trial));
  std::vector<Trial> imported;
  const auto count = ImportTrials(dir.path(), [&](Trial one) {
    imported.push_back(std::move(one));
    return absl::OkStatus();
  });
  ASSERT_TRUE(count.ok()) << count.status();
  ASSERT_EQ(imported.size(), 1u);
  EXPECT_EQ(imported[0].id, "seven");
  EXPECT_EQ(imported[0].source, trial.source);
  imported[0].id = trial.id;
  EXPECT_TRUE(SameBits(imported[0], trial));
}

TEST(TrialZarrTest, EveryTrialComesBackBitForBit) {
  const ScratchDir dir;
  std::vector<Trial> trials = {FullTrial(3, 17, false), FullTrial(4, 17, true),
                               TrialOfTouches(5, 17),
                               TrialOfAxes(6, 5, v1::TAXEL_TYPE_INT16),
                               TrialOfAxes(7, 5, v1::TAXEL_TYPE_FLOAT32)};
  ASSERT_TRUE(MakeZarrGroup(dir / "z").ok());
  for (size_t i = 0; i < trials.size(); ++i) {
    trials[i].id = std::string(1, static_cast<char>('a' + i));
    ASSERT_TRUE(TrialToZarr(trials[i], dir / "z" + "/" + trials[i].id).ok());
  }
  // Once with the slash that shells complete.
  for (const std::string& path : {dir / "z", dir / "z/"}) {
    size_t i = 0;
    const auto count = ImportTrials(path, [&](const Trial& back) {
      EXPECT_TRUE(SameBits(back, trials.at(i++)));
      return absl::OkStatus();
    });
    ASSERT_TRUE(count.ok()) << count.status();
    EXPECT_EQ(*count, trials.size());
  }
  // One trial alone, and a group with none.
  EXPECT_EQ(*ImportTrials(dir / "z/c",
                          [&](const Trial& back) {
                            EXPECT_TRUE(SameBits(back, trials[2]));
                            return absl::OkStatus();
                          }),
            1u);
  ASSERT_TRUE(MakeZarrGroup(dir / "none").ok());
  const auto none =
      ImportTrials(dir / "none", [](const Trial&) { return absl::OkStatus(); });
  EXPECT_THAT(std::string(none.status().message()),
              HasSubstr("without trials"));
}

TEST(TrialCsvTest, SignalsComeBackBitForBit) {
  const ScratchDir dir;
  const Trial trial = FullTrial(5, 30);
  const auto table = SignalsToCsv(trial);
  ASSERT_TRUE(table.ok()) << table.status();
  WriteBytes(dir / "a.csv", *table);
  const auto back = ImportSignalsCsv(dir / "a.csv", 0);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->time, trial.time);
  EXPECT_EQ(back->signals, trial.signals);
  EXPECT_EQ(back->stiffness, trial.stiffness);
  EXPECT_EQ(back->sample_rate_hz, trial.sample_rate_hz);
  EXPECT_EQ(back->label, trial.label);
  EXPECT_EQ(back->object, trial.object);
  EXPECT_EQ(back->unit, trial.unit);
}

TEST(TrialCsvTest, TaxelsAreInTheirUnit) {
  Trial trial;
  trial.time = {0, 0.5};
  trial.taxels.rows = 1;
  trial.taxels.columns = 2;
  trial.taxels.u16 = {0, 3, 4, 65535};
  trial.taxels.scale = 0.5;
  trial.label = "SM";
  const std::vector<size_t> places = {0, 1};
  EXPECT_EQ(*FramesToCsv(trial, places),
            "time,r0c0,r0c1\n0,0,1.5\n0.5,2,32767.5\n");
  trial.poses.resize(2);
  EXPECT_EQ(*FramesToCsv(trial, places),
            "time,r0c0,r0c1,x,y,z,qx,qy,qz,qw\n"
            "0,0,1.5,0,0,0,0,0,0,1\n0.5,2,32767.5,0,0,0,0,0,0,1\n");
  EXPECT_EQ(ReasonOf(SignalsToCsv(trial).status()), "TRIAL_FILE_INVALID");
  trial.signals = {{1, 2, 3}, {4, 5, 6}};
  trial.taxels = {};
  EXPECT_EQ(ReasonOf(FramesToCsv(trial, places).status()),
            "TRIAL_FILE_INVALID");
}

TEST(TrialCsvTest, TouchesAreRefused) {
  const absl::Status status = SignalsToCsv(TrialOfTouches(3, 17)).status();
  EXPECT_THAT(std::string(status.message()), HasSubstr("touches"));
}

}  // namespace
}  // namespace tactus::internal
