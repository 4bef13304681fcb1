// Recordings of skins with three axes and with signed values.
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/data/recording/recording_writer.h"
#include "core/data/trial_file.h"
#include "core/files/npy_write.h"
#include "core/files/npz.h"
#include "core/import/idle_noise.h"
#include "core/skin/layout_proto.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"
#include "tests/core/import/import_all.h"
#include "tests/support/flat_layout.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

constexpr size_t kFrames = 40;
// 2 x 3 taxels.
constexpr size_t kTaxels = 6;

// Noise, from frame 20 on a press of 100 on taxel 4.
std::vector<float> AxesValues() {
  Random random(9);
  std::vector<float> values;
  for (size_t i = 0; i < kFrames * kTaxels * 3; ++i) {
    const size_t taxel = i / 3 % kTaxels;
    const bool pressed = i / 3 / kTaxels >= 20 && taxel == 4;
    const double load = i % 3 == 2 && pressed ? 100 : 0;
    values.push_back(static_cast<float>(load + random.Uniform(-1, 1)));
  }
  return values;
}

class ImportAxesTest : public ::testing::Test {
 protected:
  // `more` is the end of the skin.json; `file` holds the frames.
  absl::StatusOr<Trial> Import(const std::string& more,
                               const std::string& file) {
    WriteBytes(dir_ / "skin.json", R"({"name": "mine", "rows": 2, "columns": 3,
                "row_pitch_m": 0.01, "column_pitch_m": 0.01,
                "unit": "counts", "sample_rate_hz": 100, )" +
                                       more + "}");
    WriteBytes(dir_ / "trials.csv", "frames,label\n" + file + ",cork\n");
    auto trials = ImportAll(dir_.path());
    if (!trials.ok()) return trials.status();
    return trials->front();
  }

  const std::string axes_ =
      R"("axes": 3, "normal_axis": 2, "signed_values": true,
         "contact_threshold": 10)";
  const std::vector<float> values_ = AxesValues();
  const ScratchDir dir_;
};

TEST_F(ImportAxesTest, EachFormatGivesTheValues) {
  const std::span<const float> all = values_;
  WriteBytes(dir_ / "a.npy", NpyBytes({kFrames, 2, 3, 3}, all));
  WriteBytes(dir_ / "b.npy", NpyBytes({kFrames, kTaxels, 3}, all));
  WriteBytes(dir_ / "c.npy", NpyBytes({kFrames, kTaxels * 3}, all));
  WriteBytes(dir_ / "d.npz",
             *NpzBytes({{"x", NpyBytes({kFrames, 2, 3, 3}, all)}}));
  std::string table = "time";
  for (size_t i = 0; i < kTaxels * 3; ++i) table += ",v" + std::to_string(i);
  for (size_t i = 0; i < values_.size(); ++i) {
    char digits[32];
    if (i % (kTaxels * 3) == 0) {
      std::snprintf(digits, sizeof(digits), "\n%.2f",
                    0.01 * static_cast<double>(i / (kTaxels * 3)));
      table += digits;
    }
    std::snprintf(digits, sizeof(digits), ",%.9g", values_[i]);
    table += digits;
  }
  WriteBytes(dir_ / "e.csv", table + "\n");
  // A trial file is an HDF5 file with a dataset of frames.
  Trial stored;
  stored.label = "cork";
  SkinLayout skin = testing::FlatLayout("x", 2, 3, TaxelUnit::kCounts, 1, 1);
  skin.axes = 3;
  skin.signed_values = true;
  for (size_t t = 0; t < kFrames; ++t) {
    stored.time.push_back(0.01 * static_cast<double>(t));
  }
  stored.taxels.SetShape(skin);
  stored.taxels.f32 = values_;
  SetSkin(skin, stored);
  auto writer = TrialFileWriter::Create(dir_ / "f.h5", {});
  ASSERT_TRUE(writer->Append(stored).ok());
  ASSERT_TRUE(writer->Close().ok());
  for (const char* file : {"a.npy", "b.npy", "c.npy", "d.npz", "e.csv",
                           "f.h5:trials/000000/taxels"}) {
    const auto trial = Import(axes_, file);
    ASSERT_TRUE(trial.ok()) << file << ": " << trial.status();
    EXPECT_EQ(trial->taxels.axes, 3) << file;
    EXPECT_EQ(trial->taxels.f32, values_) << file;
    EXPECT_EQ(trial->skin->axes, 3);
    EXPECT_EQ(trial->skin->normal_axis, 2);
    EXPECT_TRUE(trial->skin->signed_values);
  }
}

TEST_F(ImportAxesTest, ABaselineIsThatOfEachAxis) {
  std::vector<float> raised = values_;
  for (size_t i = 0; i < raised.size(); ++i) {
    raised[i] += 1000 * static_cast<float>(i % (kTaxels * 3));
  }
  WriteBytes(dir_ / "a.npy",
             NpyBytes({kFrames, 2, 3, 3}, std::span<const float>(raised)));
  const auto trial =
      Import(axes_ + R"(, "baseline": "from idle frames", "idle_frames": 20)",
             "a.npy");
  ASSERT_TRUE(trial.ok()) << trial.status();
  for (size_t i = 0; i < values_.size(); ++i) {
    // The mean of 20 numbers from -1 to 1 is 0 +- 0.13.
    EXPECT_NEAR(trial->taxels.f32[i], values_[i], 0.6) << i;
  }
}

TEST_F(ImportAxesTest, ThresholdsComeFromIdleLoads) {
  WriteBytes(dir_ / "a.npy",
             NpyBytes({kFrames, 2, 3, 3}, std::span<const float>(values_)));
  for (const bool normal : {true, false}) {
    const auto trial =
        Import(std::string(normal ? R"("normal_axis": 2, )" : "") +
                   R"("axes": 3, "signed_values": true, "masked_taxels": [1],
               "thresholds": "from idle frames", "idle_frames": 20)",
               "a.npy");
    ASSERT_TRUE(trial.ok()) << trial.status();
    // By hand, from all valid taxels of the first 20 frames.
    std::vector<float> idle;
    float peak = 0;
    for (size_t i = 0; i < kFrames * kTaxels; ++i) {
      if (i % kTaxels == 1) continue;
      const float* v = &values_[3 * i];
      const float load =
          normal ? std::max(v[2], 0.0F) : std::hypot(v[0], v[1], v[2]);
      peak = std::max(peak, load);
      if (i / kTaxels < 20) idle.push_back(load);
    }
    ASSERT_EQ(idle.size(), 100u);
    const float most = *std::ranges::max_element(idle);
    std::ranges::nth_element(idle, idle.begin() + 50);
    const double margin = std::max<double>((most - idle[50]) / 2, peak / 50);
    EXPECT_NEAR(trial->skin->contact_threshold, most + margin, 1e-5);
    EXPECT_NEAR(trial->skin->onset_threshold, most + 2 * margin, 1e-5);
  }
}

TEST_F(ImportAxesTest, NamesEachMistake) {
  WriteBytes(dir_ / "a.npy",
             NpyBytes({kFrames, 2, 3, 3}, std::span<const float>(values_)));
  const std::pair<const char*, const char*> table[] = {
      {R"("axes": 2, "contact_threshold": 1)", "axes: is 2; it must be 1 or 3"},
      {R"("axes": 4, "contact_threshold": 1)", "axes: is 4"},
      {R"("normal_axis": 1, "contact_threshold": 1)", "geometry.normal_axis"},
      {R"("axes": 3, "normal_axis": 3, "contact_threshold": 1)",
       "normal_axis: is 3; it must be a whole number from 0 to 2"},
      {R"("axes": 3, "signed_values": true, "negative_values": "zero",
          "contact_threshold": 1)",
       "negative_values: is given with signed_values"},
      {R"("axes": 3, "contact_threshold": 1)", "negative_values or signed"},
      {R"("contact_threshold": 1)", "has shape 40 x 2 x 3 x 3"},
  };
  for (const auto& [skin, what] : table) {
    const absl::Status status = Import(skin, "a.npy").status();
    EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID") << skin;
    EXPECT_THAT(std::string(status.message()), HasSubstr(what));
  }
}

// A recorded stream of int16 becomes a trial of the same numbers.
TEST_F(ImportAxesTest, ARecordingKeepsItsNumbers) {
  SkinLayout skin =
      testing::FlatLayout("mine", 2, 3, TaxelUnit::kCounts, 10, 20);
  skin.axes = 3;
  skin.normal_axis = 2;
  skin.signed_values = true;
  v1::StreamConfig config;
  *config.mutable_geometry() = LayoutToProto(skin);
  config.set_taxel_type(v1::TAXEL_TYPE_INT16);
  config.set_scale(0.5);
  auto writer = *RecordingWriter::Create(dir_ / "a.mcap", {}, {.sync = false});
  ASSERT_TRUE(writer->Write(config).ok());
  ASSERT_TRUE(writer->Write(RecordedTrial{{{"label", "cork"}}}).ok());
  std::vector<int16_t> sent;
  for (size_t t = 0; t < kFrames; ++t) {
    v1::FrameBatch frame;
    frame.set_frame_count(1);
    frame.set_first_sequence(t + 1);
    frame.set_first_capture_time_ns(static_cast<int64_t>(t) * 10'000'000);
    std::vector<int16_t> values;
    for (size_t i = 0; i < kTaxels * 3; ++i) {
      const float value = 2 * values_[t * kTaxels * 3 + i];
      values.push_back(static_cast<int16_t>(std::lround(value)));
    }
    frame.mutable_taxels()->assign(reinterpret_cast<const char*>(values.data()),
                                   2 * values.size());
    sent.insert(sent.end(), values.begin(), values.end());
    ASSERT_TRUE(writer->Write(frame).ok());
  }
  ASSERT_TRUE(writer->Write(v1::EndOfTrial()).ok());
  ASSERT_TRUE(writer->Finish({}).ok());
  const auto trials = ImportAll(dir_ / "a.mcap");
  ASSERT_TRUE(trials.ok()) << trials.status();
  ASSERT_EQ(trials->size(), 1u);
  const TaxelSeries& taxels = trials->front().taxels;
  EXPECT_EQ(taxels.i16, sent);
  EXPECT_EQ(taxels.scale, 0.5);
  EXPECT_EQ(taxels.axes, 3);
  EXPECT_EQ(trials->front().skin, skin);
}

// Frames of six taxels, with the angles of two joints between them.
TEST_F(ImportAxesTest, AuxiliaryColumnsFollowTheTaxels) {
  std::string table = "time,elbow,a,b,c,d,e,f,wrist\n";
  for (int t = 0; t < 30; ++t) {
    table += std::to_string(0.01 * t) + ",-0.5,1005,1004,1003,1002,1001,1000,";
    table += std::to_string(t) + "\n";
  }
  WriteBytes(dir_ / "a.csv", table);
  const auto trial = Import(R"("contact_threshold": 1, "baseline": 1000,
      "scale": 2, "auxiliary_values": 2,
      "auxiliary_columns": ["wrist", "elbow"])",
                            "a.csv");
  ASSERT_TRUE(trial.ok()) << trial.status();
  EXPECT_EQ(trial->skin->rows, 3);
  EXPECT_EQ(trial->skin->auxiliary, (std::vector<uint32_t>{6, 7}));
  EXPECT_EQ(trial->skin->mask,
            (std::vector<uint8_t>{1, 1, 1, 1, 1, 1, 0, 0, 0}));
  std::vector<float> frame(9);
  trial->taxels.Decode(7, frame.data());
  EXPECT_EQ(frame, (std::vector<float>{10, 8, 6, 4, 2, 0, 7, -0.5F, 0}));
  // A touch below 0 stays a mistake.
  WriteBytes(dir_ / "a.csv", table + "0.3,0,999,0,0,0,0,0,0\n");
  EXPECT_THAT(Import(R"("contact_threshold": 1, "baseline": 1000,
      "auxiliary_values": 2, "auxiliary_columns": ["wrist", "elbow"])",
                     "a.csv")
                  .status()
                  .message(),
              HasSubstr("taxel 0 of frame 30 is -1; it must be 0 to 1e12"));
}

TEST_F(ImportAxesTest, AuxiliaryValuesAreTheLastOfAFrame) {
  std::vector<float> all;
  for (size_t i = 0; i < kFrames * 8; ++i) {
    all.push_back(i % 8 < kTaxels ? 3 : -4);
  }
  WriteBytes(dir_ / "a.npy",
             NpyBytes({kFrames, 8}, std::span<const float>(all)));
  const auto trial =
      Import(R"("contact_threshold": 1, "auxiliary_values": 2)", "a.npy");
  ASSERT_TRUE(trial.ok()) << trial.status();
  std::vector<float> frame(9);
  trial->taxels.Decode(0, frame.data());
  EXPECT_EQ(frame, (std::vector<float>{3, 3, 3, 3, 3, 3, -4, -4, 0}));
  EXPECT_THAT(
      Import(R"("contact_threshold": 1, "auxiliary_columns": ["6"])", "a.npy")
          .status()
          .message(),
      HasSubstr("say how many auxiliary_columns there are"));
}

}  // namespace
}  // namespace tactus::internal
