// Recordings become trials: one for each contact, cut where a stream would
// report its onset and its release.
#include "core/import/import_recording.h"

#include "core/base/errors.h"
#include "core/data/recording/recording_writer.h"
#include "core/features/contact_tracker.h"
#include "core/skin/layout_proto.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/import/import_all.h"
#include "tests/support/flat_layout.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace std::string_literals;

// 2 x 2 counts at 100 Hz; a contact begins at 20 and goes on from 10.
SkinLayout RecordedSkin() {
  return testing::FlatLayout("mine", 2, 2, TaxelUnit::kCounts, 10, 20);
}

// Writes a recording frame by frame.
class RecordingScript {
 public:
  explicit RecordingScript(const std::string& path, int release_after_ms = 100)
      : writer_(*RecordingWriter::Create(path, {}, {.sync = false})) {
    v1::StreamConfig config;
    *config.mutable_geometry() = LayoutToProto(RecordedSkin());
    config.set_taxel_type(v1::TAXEL_TYPE_UINT16);
    config.set_with_poses(true);
    config.set_release_after_ms(release_after_ms);
    EXPECT_TRUE(writer_->Write(config).ok());
  }

  void Trial(const std::string& label) {
    EXPECT_TRUE(
        writer_->Write(RecordedTrial{{{"id", "a"}, {"label", label}}}).ok());
  }
  void Frames(int count, uint16_t value) {
    for (int i = 0; i < count; ++i) {
      v1::FrameBatch frame;
      frame.set_frame_count(1);
      frame.set_first_sequence(++sequence_);
      frame.set_first_capture_time_ns(static_cast<int64_t>(sequence_) *
                                      10'000'000);
      const char taxels[8] = {static_cast<char>(value & 0xff),
                              static_cast<char>(value >> 8)};
      frame.mutable_taxels()->assign(taxels, 8);
      const double x = static_cast<double>(sequence_);
      for (const double p : {x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}) {
        frame.add_poses(p);
      }
      EXPECT_TRUE(writer_->Write(frame).ok());
    }
  }
  void Lose(int count) { sequence_ += count; }
  void EndTrial() { EXPECT_TRUE(writer_->Write(v1::EndOfTrial()).ok()); }
  void Finish() { EXPECT_TRUE(writer_->Finish({}).ok()); }

 private:
  std::unique_ptr<RecordingWriter> writer_;
  uint64_t sequence_ = 0;
};

// Three contacts in one trial of 480 frames: at frames 150, 195 and 450.
void WriteThreeContacts(const std::string& path, const std::string& label) {
  RecordingScript script(path);
  script.Trial(label);
  script.Frames(150, 1);
  script.Frames(20, 500);
  script.Frames(25, 1);
  script.Frames(5, 300);
  script.Frames(250, 1);
  script.Frames(30, 200);
  script.Finish();
}

TEST(ImportRecordingTest, CutsAtOnsetAndRelease) {
  const ScratchDir folder;
  WriteThreeContacts(folder / "a.mcap", "HU");
  std::vector<std::string> remarks;
  const auto trials = ImportAll(
      folder / "a.mcap",
      {.remark = [&](const std::string& text) { remarks.push_back(text); }});
  ASSERT_TRUE(trials.ok()) << trials.status();
  EXPECT_THAT(remarks, IsEmpty());
  ASSERT_EQ(trials->size(), 3U);
  // A second before the onset, the contact, and the 10 frames of its release.
  const std::pair<size_t, double> expected[] = {
      {100 + 20 + 10, 51}, {15 + 5 + 10, 181}, {100 + 30, 351}};
  for (size_t i = 0; i < 3; ++i) {
    const Trial& trial = (*trials)[i];
    EXPECT_EQ(trial.id, absl::StrCat("00000", i + 1));
    EXPECT_EQ(trial.label, "HU");
    EXPECT_EQ(trial.time.size(), expected[i].first) << i;
    // The x of a pose is its sequence number.
    ASSERT_EQ(trial.poses.size(), trial.time.size());
    EXPECT_EQ(trial.poses[0].position.x(), expected[i].second) << i;
    EXPECT_EQ(trial.sample_rate_hz, 100);
    EXPECT_DOUBLE_EQ(trial.time[1], 0.01);
    EXPECT_EQ(trial.skin, RecordedSkin());
    // Each has one contact for the tracker too.
    ContactTracker tracker(RecordedSkin(), {.release_after_s = 0.1});
    std::vector<float> taxels(4);
    int onsets = 0;
    for (size_t t = 0; t < trial.time.size(); ++t) {
      trial.taxels.Decode(t, taxels.data());
      tracker.Step({.taxels = taxels});
      onsets += tracker.onset();
    }
    EXPECT_EQ(onsets, 1);
  }
}

// The trials are those of the loads, and the remark says so.
TEST(ImportRecordingTest, OfACalibratedSkinTheLoadsAreImported) {
  const ScratchDir folder;
  {
    const auto writer = *RecordingWriter::Create(
        folder / "a.mcap", {{"device", "palm"}}, {.sync = false});
    v1::StreamConfig config;
    *config.mutable_geometry() = LayoutToProto(RecordedSkin());
    config.set_taxel_type(v1::TAXEL_TYPE_UINT16);
    ASSERT_TRUE(writer->Write(config).ok());
    ASSERT_TRUE(writer->Write(RecordedTrial{{{"label", "HU"}}}).ok());
    ASSERT_TRUE(writer->Write(RecordedCalibration{config, "{}"}).ok());
    for (int i = 1; i <= 40; ++i) {
      v1::FrameBatch frame;
      frame.set_frame_count(1);
      frame.set_first_sequence(i);
      frame.set_first_capture_time_ns(10'000'000 * i);
      *frame.mutable_taxels() = i < 20 ? std::string(8, '\0') : "d\0d\0d\0d\0"s;
      ASSERT_TRUE(writer->Write(frame).ok());
      RawFrame raw{frame};
      *raw.batch.mutable_taxels() = "zzzzzzzz";
      ASSERT_TRUE(writer->Write(raw).ok());
    }
    ASSERT_TRUE(writer->Finish({}).ok());
  }
  std::vector<std::string> remarks;
  const auto trials = ImportAll(
      folder / "a.mcap",
      {.remark = [&](const std::string& text) { remarks.push_back(text); }});
  ASSERT_TRUE(trials.ok()) << trials.status();
  ASSERT_EQ(trials->size(), 1U);
  EXPECT_EQ((*trials)[0].taxels.u16.front(), 0);
  EXPECT_EQ((*trials)[0].taxels.u16.back(), 'd');
  EXPECT_THAT(remarks,
              ElementsAre(folder / "a.mcap" +
                          ": the trials hold the loads of /skin/frames; 40 "
                          "frames of /skin/raw, as the skin \"palm\" sent "
                          "them, stay in the recording"));
}

TEST(ImportRecordingTest, ATableNamesTheContacts) {
  const ScratchDir folder;
  WriteThreeContacts(folder / "a.mcap", "");
  const auto import = [&](const std::string& table,
                          std::vector<std::string>* remarks = nullptr) {
    WriteBytes(folder / "t.csv", table);
    return ImportAll(folder / "a.mcap", {.table = folder / "t.csv",
                                         .remark = [=](const auto& text) {
                                           if (remarks)
                                             remarks->push_back(text);
                                         }});
  };
  std::vector<std::string> remarks;
  const auto trials =
      import("contact,label,object\n1,left,cup\n2,,\n3,right,ball\n", &remarks);
  ASSERT_TRUE(trials.ok()) << trials.status();
  ASSERT_EQ(trials->size(), 2U);
  EXPECT_EQ((*trials)[0].label, "left");
  EXPECT_EQ((*trials)[0].object, "cup");
  EXPECT_EQ((*trials)[1].id, "000003");
  EXPECT_EQ((*trials)[1].label, "right");
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_THAT(remarks[0], HasSubstr("contact 2, 1.95 s after the first frame: "
                                    "left out"));
  const std::pair<std::string, std::string> mistakes[] = {
      {"contact,label\n1,a\n2,a\n",
       "contact 3, 4.50 s after the first frame, has no label"},
      {"contact,label\n1,a\n2,a\n3,a\n4,b\n", "line 5: contact: is 4; "},
      {"contact,label\n1,a\n1,b\n", "line 3: contact: 1 is repeated"},
      {"contact,label\nx,a\n", "line 2: contact: is \"x\""},
      {"contact,label\n0,a\n", "line 2: contact: is \"0\""},
      {"contact,labels\n1,a\n", "has the column \"labels\""},
      {"label\na\n", "contact"},
  };
  for (const auto& [table, text] : mistakes) {
    const auto failed = import(table);
    EXPECT_EQ(ReasonOf(failed.status()), "TRIAL_FILE_INVALID") << table;
    EXPECT_THAT(std::string(failed.status().message()), HasSubstr(text));
  }
}

TEST(ImportRecordingTest, ContactsWithoutALabelMayBeGivenOne) {
  const ScratchDir folder;
  WriteThreeContacts(folder / "a.mcap", "");
  WriteBytes(folder / "t.csv", "contact,label\n1,left\n2,\n");
  const auto trials = ImportAll(folder / "a.mcap",
                                {.table = folder / "t.csv", .label = "other"});
  ASSERT_TRUE(trials.ok()) << trials.status();
  // What the table leaves out stays out.
  ASSERT_EQ(trials->size(), 2U);
  EXPECT_EQ((*trials)[0].label, "left");
  EXPECT_EQ((*trials)[1].id, "000003");
  EXPECT_EQ((*trials)[1].label, "other");
}

TEST(ImportRecordingTest, LostFramesAndEmptyTrialsAreRemarked) {
  const ScratchDir folder;
  RecordingScript script(folder / "a.mcap", 0);
  script.Trial("HU");
  script.Frames(20, 1);
  script.EndTrial();
  script.Trial("SM");
  script.Frames(5, 1);
  script.Frames(10, 100);
  script.Lose(3);
  script.Frames(10, 100);
  script.EndTrial();
  script.Finish();
  std::vector<std::string> remarks;
  const auto trials = ImportAll(
      folder / "a.mcap",
      {.remark = [&](const std::string& text) { remarks.push_back(text); }});
  ASSERT_TRUE(trials.ok()) << trials.status();
  ASSERT_EQ(trials->size(), 1U);
  EXPECT_EQ((*trials)[0].label, "SM");
  // No frame of the trial before.
  EXPECT_EQ((*trials)[0].poses[0].position.x(), 21);
  EXPECT_THAT(
      remarks,
      ElementsAre("trial a (HU): no contact was felt in its 20 frames",
                  "contact 1, 0.25 s after the first frame: 3 of its frames "
                  "are missing"));
}

TEST(ImportRecordingTest, ACutOffRecordingIsImportedUpToItsEnd) {
  const ScratchDir folder;
  WriteThreeContacts(folder / "a.mcap", "HU");
  const std::string bytes = ReadBytes(folder / "a.mcap");
  WriteBytes(folder / "b.mcap", bytes.substr(0, bytes.size() * 3 / 5));
  std::vector<std::string> remarks;
  const auto trials = ImportAll(
      folder / "b.mcap",
      {.remark = [&](const std::string& text) { remarks.push_back(text); }});
  ASSERT_TRUE(trials.ok()) << trials.status();
  EXPECT_EQ(trials->size(), 2U);
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_THAT(remarks[0], HasSubstr("was cut off"));
}

TEST(ImportRecordingTest, AnotherSkinOfTheSameShapeMayBeGiven) {
  const ScratchDir folder;
  WriteThreeContacts(folder / "a.mcap", "HU");
  const auto import = [&](int rows, int onset) {
    WriteBytes(folder / "skin.json",
               absl::StrCat(R"({"name": "mine", "rows": )", rows,
                            R"(, "columns": 2, "row_pitch_m": 0.01,
                             "column_pitch_m": 0.01, "unit": "counts",
                             "contact_threshold": 10, "onset_threshold": )",
                            onset, "}"));
    return ImportAll(folder / "a.mcap", {.skin = folder / "skin.json"});
  };
  const auto trials = import(2, 400);
  ASSERT_TRUE(trials.ok()) << trials.status();
  EXPECT_EQ(trials->size(), 1U);
  EXPECT_EQ((*trials)[0].skin->onset_threshold, 400);
  EXPECT_THAT(std::string(import(2, 2000).status().message()),
              HasSubstr("holds no contact"));
  EXPECT_THAT(std::string(import(3, 20).status().message()),
              HasSubstr("rows: the skin has 3 x 2 taxels; the recording has "
                        "2 x 2"));
}

TEST(ImportRecordingTest, AnImpossibleValueIsNamed) {
  const ScratchDir folder;
  {
    const auto writer =
        *RecordingWriter::Create(folder / "a.mcap", {}, {.sync = false});
    v1::StreamConfig config;
    *config.mutable_geometry() = LayoutToProto(RecordedSkin());
    config.set_taxel_type(v1::TAXEL_TYPE_FLOAT32);
    ASSERT_TRUE(writer->Write(config).ok());
    v1::FrameBatch frame;
    frame.set_frame_count(1);
    frame.set_first_sequence(9);
    const float taxels[] = {0, 1, -5, 0};
    frame.mutable_taxels()->assign(reinterpret_cast<const char*>(taxels), 16);
    ASSERT_TRUE(writer->Write(frame).ok());
    ASSERT_TRUE(writer->Finish({}).ok());
  }
  EXPECT_THAT(std::string(ImportAll(folder / "a.mcap").status().message()),
              HasSubstr("taxel 2 of the frame with the sequence number 9 is "
                        "-5; it must be 0 to 1e+12"));
}

}  // namespace
}  // namespace tactus::internal
