// Streams that are recorded and replayed against an in-process server.
#include <sys/resource.h>

#include <csignal>

#include "client/drivers/recording_driver.h"
#include "client/drivers/sim_driver.h"
#include "client/recording/answer_check.h"
#include "client/recording/recorder.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"
#include "tests/support/scratch_dir.h"
#include "tools/stream/live_player.h"
#include "tools/stream/record_replay.h"
#include "tools/stream/trial_player.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;
using testing::TestServer;

// Contacts on a skin without an end of trials. Frames are lost, in contact too.
class LossySkin : public SkinDriver {
 public:
  LossySkin(bool u16, bool poses) {
    info_.layout = *LayoutPreset("cody-forearm");
    info_.taxel_type = u16 ? v1::TAXEL_TYPE_UINT16 : v1::TAXEL_TYPE_FLOAT32;
    info_.scale = u16 ? 0.001 : 1;
    info_.with_poses = poses;
    for (uint64_t seed = 1; seed <= 3; ++seed) {
      for (const auto& frame : testing::Contact(60, seed)) {
        frames_.push_back(frame);
      }
      frames_.resize(frames_.size() + 70, frames_[0]);
      for (auto f = frames_.end() - 70; f != frames_.end(); ++f) {
        f->assign(f->size(), 0);
      }
    }
  }

 protected:
  absl::StatusOr<SkinInfo> OnConfigure() override { return info_; }
  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override {
    if (at_ == frames_.size()) return ReadResult::kEndOfData;
    frame.missing_before = at_ % 17 == 3 ? 2 : at_ == 0;
    time_ns_ += 10'000'123 * static_cast<int64_t>(1 + frame.missing_before);
    frame.capture_time_ns = time_ns_;
    frame.u16 = frames_[at_];
    frame.f32 = testing::Newtons(frames_[at_]);
    frame.pose.position = {1e-4 * static_cast<double>(at_), 0.1, 0.2};
    ++at_;
    return ReadResult::kFrame;
  }

 private:
  SkinInfo info_;
  std::vector<std::vector<uint16_t>> frames_;
  size_t at_ = 0;
  int64_t time_ns_ = 1'700'000'000'000'000'000;
};

void Drop(const LiveContact& /*contact*/) {}
void DropNews(const std::string& /*news*/) {}

// Records 4 simulated contacts.
void RecordSim(TestServer& server, const std::string& path, uint32_t batch) {
  const auto recorder = *Recorder::Create(
      path, {.about = {{"stream", "trials"}, {"batch", absl::StrCat(batch)}},
             .wait_when_full = true,
             .sync = false});
  SimDriver driver({.seed = 5, .lead_in_frames = 20}, 4, {});
  TrialPlayer player(server.channel(), &driver,
                     {.batch = batch, .recorder = recorder.get()},
                     [](const TrialResult&) {});
  const absl::Status status = player.Run();
  ASSERT_TRUE(status.ok()) << status;
  ASSERT_TRUE(recorder->Finish().ok());
  EXPECT_EQ(recorder->totals().frames, player.totals().frames);
  EXPECT_EQ(recorder->totals().lost_frames, 0U);
  EXPECT_EQ(recorder->totals().results, player.totals().frames + 4);
}

struct Replay {
  absl::Status status;
  AnswerCheck::Counts counts;
  std::string text;
  std::vector<std::string> labels;
  std::string problem;
};

Replay ReplayTrials(TestServer& server, const std::string& path,
                    size_t max_trials = 0, const std::string& record = "") {
  Replay replay;
  AnswerCheck check;
  std::unique_ptr<Recorder> recorder;
  if (!record.empty()) {
    recorder = *Recorder::Create(
        record, {.about = {{"stream", "trials"}, {"batch", "1"}},
                 .wait_when_full = true,
                 .sync = false});
  }
  RecordingDriver driver(
      path, {.max_trials = max_trials, .on_event = EventsTo(check)});
  const auto start = ReadRecordingStart(path);
  TrialPlayer player(server.channel(), &driver,
                     {.batch = start.ok() ? start->batch : 1,
                      .recorder = recorder.get(),
                      .check = &check},
                     [&](const TrialResult&) {
                       replay.labels.push_back(driver.trial().label);
                     });
  replay.status = player.Run();
  replay.counts = check.Result();
  replay.text = check.Text();
  replay.problem = driver.Statistics().problem;
  return replay;
}

TEST(ReplayTest, TrialsGiveTheRecordedPosteriorsBitForBit) {
  const ScratchDir folder;
  for (const uint32_t batch : {1U, 7U}) {
    const std::string path = folder / absl::StrCat(batch, ".mcap");
    TestServer server;
    RecordSim(server, path, batch);
    const Replay replay = ReplayTrials(server, path);
    ASSERT_TRUE(replay.status.ok()) << replay.status;
    EXPECT_GT(replay.counts.equal, 400U);
    EXPECT_EQ(replay.text,
              absl::StrCat(replay.counts.equal, " of ", replay.counts.equal,
                           " answers equal the recording's"));
    EXPECT_EQ(replay.labels,
              (std::vector<std::string>{"HU", "HM", "SU", "SM"}));
    EXPECT_EQ(replay.problem, "");
  }
}

TEST(ReplayTest, ARecordingOfAReplayIsTheRecording) {
  const ScratchDir folder;
  TestServer server;
  RecordSim(server, folder / "a.mcap", 1);
  ASSERT_TRUE(ReplayTrials(server, folder / "a.mcap", 0, folder / "b.mcap")
                  .status.ok());
  const auto a = *RecordingReader::Open(folder / "a.mcap");
  const auto b = *RecordingReader::Open(folder / "b.mcap");
  const auto next_frame = [](RecordingReader& reader, v1::FrameBatch& frame) {
    RecordingEvent event;
    while (*reader.Next(event)) {
      if (!std::holds_alternative<v1::FrameBatch>(event)) continue;
      frame = std::get<v1::FrameBatch>(event);
      return true;
    }
    return false;
  };
  v1::FrameBatch x;
  v1::FrameBatch y;
  int frames = 0;
  while (next_frame(*a, x)) {
    ASSERT_TRUE(next_frame(*b, y));
    ASSERT_EQ(x.SerializeAsString(), y.SerializeAsString());
    ++frames;
  }
  EXPECT_FALSE(next_frame(*b, y));
  EXPECT_GT(frames, 400);
}

TEST(ReplayTest, SomeTrialsAreAsManyAsWereAskedFor) {
  const ScratchDir folder;
  TestServer server;
  RecordSim(server, folder / "a.mcap", 1);
  const Replay replay = ReplayTrials(server, folder / "a.mcap", 2);
  ASSERT_TRUE(replay.status.ok()) << replay.status;
  EXPECT_EQ(replay.labels, (std::vector<std::string>{"HU", "HM"}));
  EXPECT_EQ(replay.counts.only_received + replay.counts.different, 0U);
}

TEST(ReplayTest, ACutOffRecordingReplaysToItsEnd) {
  const ScratchDir folder;
  TestServer server;
  RecordSim(server, folder / "a.mcap", 1);
  const std::string bytes = ReadBytes(folder / "a.mcap");
  WriteBytes(folder / "b.mcap", bytes.substr(0, bytes.size() * 3 / 5));
  const Replay replay = ReplayTrials(server, folder / "b.mcap");
  ASSERT_TRUE(replay.status.ok()) << replay.status;
  EXPECT_THAT(replay.problem, HasSubstr("was cut off"));
  EXPECT_GT(replay.counts.equal, 100U);
  EXPECT_EQ(replay.counts.different, 0U);
}

TEST(ReplayTest, ASkinWithLostFramesGivesTheRecordedPosteriorsBitForBit) {
  const ScratchDir folder;
  TestServer server;
  for (const bool u16 : {false, true}) {
    const std::string path = folder / (u16 ? "u16.mcap" : "f32.mcap");
    const auto recorder =
        *Recorder::Create(path, {.about = {{"stream", "skin"}}, .sync = false});
    LossySkin skin(u16, true);
    LivePlayer player(server.channel(), &skin,
                      {.release_after_ms = 300,
                       .recorder = recorder.get(),
                       .trial = {{"label", "HU"}}},
                      Drop, DropNews);
    absl::Status status = player.Run();
    ASSERT_TRUE(status.ok()) << status;
    ASSERT_TRUE(recorder->Finish().ok());
    const auto start = ReadRecordingStart(path);
    ASSERT_TRUE(start.ok()) << start.status();
    EXPECT_TRUE(start->is_live);
    EXPECT_EQ(start->config.release_after_ms(), 300U);
    EXPECT_EQ(start->trial.Text("label"), "HU");
    AnswerCheck check;
    RecordingDriver driver(path, {.on_event = EventsTo(check)});
    int contacts = 0;
    LivePlayer again(
        server.channel(), &driver, {.release_after_ms = 300, .check = &check},
        [&](const LiveContact&) { ++contacts; }, DropNews);
    status = again.Run();
    ASSERT_TRUE(status.ok()) << status;
    EXPECT_EQ(contacts, 3);
    EXPECT_EQ(again.missing(), player.missing());
    EXPECT_GT(again.missing(), 40U);
    const AnswerCheck::Counts counts = check.Result();
    EXPECT_GT(counts.equal, 6U);
    EXPECT_EQ(counts.different, 0U) << check.Text();
    EXPECT_TRUE(check.SameModel());
  }
}

// A skin whose taxels have offsets, and what was measured of it.
class OffsetSkin : public LossySkin {
 public:
  OffsetSkin() : LossySkin(true, true) {}

  static double Offset(size_t taxel) {
    return 20 + static_cast<double>(taxel % 7);
  }

 protected:
  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override {
    TACTUS_ASSIGN_OR_RETURN(const ReadResult result, LossySkin::OnRead(frame));
    for (size_t i = 0; i < frame.u16.size(); ++i) {
      frame.u16[i] += static_cast<uint16_t>(Offset(i));
    }
    return result;
  }
};

Calibration OffsetCalibration(double threshold) {
  Calibration calibration;
  calibration.device = "palm";
  calibration.layout = *LayoutPreset("cody-forearm");
  calibration.frames = 100;
  for (size_t i = 0; i < 384; ++i) {
    calibration.baseline.push_back(OffsetSkin::Offset(i));
    calibration.deviation.push_back(1);
    calibration.contact_threshold.push_back(threshold);
    calibration.onset_threshold.push_back(threshold + 2);
  }
  return calibration;
}

std::vector<v1::FrameBatch> FramesOf(const std::string& path, bool raw) {
  const auto reader = *RecordingReader::Open(path);
  std::vector<v1::FrameBatch> frames;
  RecordingEvent event;
  while (*reader->Next(event)) {
    if (const auto* f = std::get_if<v1::FrameBatch>(&event); f && !raw) {
      frames.push_back(*f);
    }
    if (const auto* f = std::get_if<RawFrame>(&event); f && raw) {
      frames.push_back(f->batch);
    }
  }
  EXPECT_TRUE(reader->end().contains("frames"));
  return frames;
}

// Streams and records a calibrated skin; the posteriors go to `check`.
absl::Status RecordCalibrated(TestServer& server, SkinDriver& skin,
                              CalibratedDriverOptions options,
                              const std::string& path, AnswerCheck* check) {
  const auto recorder = *Recorder::Create(
      path, {.about = {{"stream", "skin"}, {"device", options.device}},
             .sync = false});
  CalibratedDriver driver(&skin, std::move(options));
  LivePlayer player(server.channel(), &driver,
                    {.release_after_ms = 300,
                     .recorder = recorder.get(),
                     .calibrated = &driver,
                     .check = check},
                    Drop, DropNews);
  TACTUS_RETURN_IF_ERROR(player.Run());
  return recorder->Finish();
}

TEST(ReplayTest, ACalibratedSkinIsRecordedAsItSentAndCalibratedAgain) {
  const ScratchDir folder;
  TestServer server;
  const std::vector<double> tare(384, 19);
  OffsetSkin skin;
  absl::Status status = RecordCalibrated(
      server, skin,
      {.device = "palm", .calibration = OffsetCalibration(8), .tare = tare},
      folder / "a.mcap", nullptr);
  ASSERT_TRUE(status.ok()) << status;
  // Raw frames are what the skin sent.
  const auto raw = FramesOf(folder / "a.mcap", true);
  OffsetSkin again;
  ASSERT_TRUE(again.Configure().ok() && again.Activate().ok());
  SkinFrame frame;
  for (const v1::FrameBatch& batch : raw) {
    ASSERT_EQ(*again.Read(frame), ReadResult::kFrame);
    ASSERT_EQ(batch.taxels(),
              std::string(reinterpret_cast<const char*>(frame.u16.data()),
                          2 * frame.u16.size()));
    ASSERT_EQ(batch.first_capture_time_ns(), frame.capture_time_ns);
  }
  EXPECT_EQ(*again.Read(frame), ReadResult::kEndOfData);
  const auto start = ReadRecordingStart(folder / "a.mcap");
  ASSERT_TRUE(start.ok()) << start.status();
  EXPECT_EQ(start->device, "palm");
  ASSERT_TRUE(start->calibration);
  EXPECT_EQ(start->calibration->calibration, OffsetCalibration(8));
  EXPECT_EQ(start->calibration->tare, tare);
  // Without a calibration, the loads are played; with the same one, the same
  // loads are made again, with the tare of the recording; with another one,
  // other loads.
  const auto loads = FramesOf(folder / "a.mcap", false);
  ASSERT_EQ(loads.size(), raw.size());
  for (const double threshold : {0.0, 8.0, 300.0}) {
    AnswerCheck check;
    RecordingDriver recording(
        folder / "a.mcap", {.raw = threshold > 0, .on_event = EventsTo(check)});
    const std::string path = folder / absl::StrCat(threshold, ".mcap");
    if (threshold == 0) {
      LivePlayer player(server.channel(), &recording,
                        {.release_after_ms = 300, .check = &check}, Drop,
                        DropNews);
      status = player.Run();
      ASSERT_TRUE(status.ok()) << status;
    } else {
      status = RecordCalibrated(
          server, recording,
          Recalibration(*start, {.calibration = OffsetCalibration(threshold)}),
          path, &check);
      ASSERT_TRUE(status.ok()) << status;
      const auto made = FramesOf(path, false);
      ASSERT_EQ(made.size(), loads.size());
      size_t equal = 0;
      for (size_t i = 0; i < loads.size(); ++i) {
        equal += made[i].SerializeAsString() == loads[i].SerializeAsString();
      }
      EXPECT_EQ(equal == loads.size(), threshold == 8) << equal;
      const auto made_raw = FramesOf(path, true);
      ASSERT_EQ(made_raw.size(), raw.size());
      for (size_t i = 0; i < raw.size(); ++i) {
        ASSERT_EQ(made_raw[i].SerializeAsString(), raw[i].SerializeAsString());
      }
    }
    const AnswerCheck::Counts counts = check.Result();
    EXPECT_EQ(counts.different == 0, threshold < 300) << check.Text();
    if (threshold < 300) {
      EXPECT_GT(counts.equal, 6U);
      EXPECT_EQ(counts.only_recorded, 0U);
    }
  }
}

// A skin that was recorded without a calibration gets one afterwards.
TEST(ReplayTest, ASkinWithoutACalibrationIsCalibratedAfterwards) {
  const ScratchDir folder;
  TestServer server;
  {
    const auto recorder = *Recorder::Create(
        folder / "a.mcap",
        {.about = {{"stream", "skin"}, {"device", "palm"}}, .sync = false});
    OffsetSkin skin;
    LivePlayer player(server.channel(), &skin, {.recorder = recorder.get()},
                      Drop, DropNews);
    ASSERT_TRUE(player.Run().ok());
    ASSERT_TRUE(recorder->Finish().ok());
  }
  const auto start = ReadRecordingStart(folder / "a.mcap");
  ASSERT_TRUE(start.ok()) << start.status();
  EXPECT_FALSE(start->calibration);
  RecordingDriver recording(folder / "a.mcap", {.raw = true});
  OffsetSkin skin;
  const CalibratedDriverOptions options =
      Recalibration(*start, {.calibration = OffsetCalibration(8)});
  CalibratedDriver afterwards(&recording, options);
  CalibratedDriver at_once(&skin, options);
  for (CalibratedDriver* driver : {&afterwards, &at_once}) {
    const auto info = driver->Configure();
    ASSERT_TRUE(info.ok()) << info.status();
    ASSERT_TRUE(driver->Activate().ok());
  }
  SkinFrame a;
  SkinFrame b;
  int frames = 0;
  while (*at_once.Read(a) == ReadResult::kFrame) {
    ASSERT_EQ(*afterwards.Read(b), ReadResult::kFrame);
    ASSERT_EQ(a.f32, b.f32);
    ASSERT_EQ(a.missing_before, b.missing_before);
    ASSERT_EQ(a.capture_time_ns, b.capture_time_ns);
    ASSERT_EQ(a.pose.position, b.pose.position);
    ++frames;
  }
  EXPECT_GT(frames, 300);
}

// At the pace of their capture times, across a gap of a quarter of a second,
// frames are the same as at once.
TEST(ReplayTest, ThePaceChangesNoFrame) {
  const ScratchDir folder;
  const auto recorder = *Recorder::Create(folder / "a.mcap", {.sync = false});
  LossySkin skin(true, true);
  const SkinInfo info = *skin.Configure();
  ASSERT_TRUE(skin.Activate().ok());
  recorder->Begin(info, MakeConfig(info), {});
  recorder->BeginTrial(RecordingTexts());
  SkinFrame frame;
  for (int i = 0; i < 60; ++i) {
    ASSERT_EQ(*skin.Read(frame), ReadResult::kFrame);
    frame.capture_time_ns = 1'000'000 * (i + (i < 30 ? 0 : 250));
    recorder->Frame(frame);
  }
  ASSERT_TRUE(recorder->Finish().ok());
  const auto read = [&](bool real_time) {
    RecordingDriver driver(folder / "a.mcap", {.real_time = real_time});
    EXPECT_EQ(*driver.Configure(), info);
    EXPECT_TRUE(driver.Activate().ok());
    std::vector<std::tuple<int64_t, uint64_t, std::vector<uint16_t>>> frames;
    SkinFrame f;
    while (true) {
      const ReadResult result = *driver.Read(f);
      if (result == ReadResult::kEndOfData) return frames;
      if (result != ReadResult::kFrame) continue;
      frames.emplace_back(f.capture_time_ns, f.missing_before, f.u16);
    }
  };
  const auto frames = read(false);
  EXPECT_EQ(frames.size(), 60U);
  EXPECT_EQ(read(true), frames);
}

TEST(AnswerCheckTest, FindsOneBitAndAnotherModel) {
  v1::Answer recorded;
  recorded.set_sequence(7);
  recorded.add_contacts()->add_probability(0.5);
  recorded.mutable_diagnostics()->set_queue_ns(1);
  v1::Answer received = recorded;
  received.mutable_diagnostics()->set_queue_ns(2);
  AnswerCheck check;
  check.Expect(recorded);
  check.Receive(received);
  EXPECT_EQ(check.Text(), "1 of 1 answers equal the recording's");
  recorded.set_sequence(8);
  received.set_sequence(8);
  received.mutable_contacts(0)->set_probability(0, std::nextafter(0.5, 1));
  check.Receive(received);
  check.Expect(recorded);
  check.ExpectModel("a");
  check.ReceiveModel("b");
  recorded.set_sequence(9);
  check.Expect(recorded);
  received.set_is_final(true);
  check.Receive(received);
  EXPECT_EQ(check.Text(),
            "1 of 3 answers equal the recording's; the model is another "
            "one; 1 differ, from frame 8 on; 1 did not come; 1 were not "
            "recorded");
}

// What the file holds and what was lost add up, whatever the disk does.
TEST(RecorderTest, CountsWhatASmallQueueLoses) {
  const ScratchDir folder;
  const auto recorder =
      *Recorder::Create(folder / "a.mcap", {.queue_bytes = 1, .sync = false});
  LossySkin skin(true, false);
  const SkinInfo info = *skin.Configure();
  ASSERT_TRUE(skin.Activate().ok());
  recorder->Begin(info, MakeConfig(info), {});
  recorder->BeginTrial(RecordingTexts());
  SkinFrame frame;
  uint64_t frames = 0;
  while (*skin.Read(frame) == ReadResult::kFrame) {
    for (int i = 0; i < 20; ++i) {
      ++frame.capture_time_ns;
      recorder->Frame(frame);
      ++frames;
    }
  }
  ASSERT_TRUE(recorder->Finish().ok());
  const Recorder::Totals& totals = recorder->totals();
  EXPECT_EQ(totals.frames + totals.lost_frames, frames);
  const auto reader = *RecordingReader::Open(folder / "a.mcap");
  RecordingEvent event;
  uint64_t kept = 0;
  while (*reader->Next(event)) {
    kept += std::holds_alternative<v1::FrameBatch>(event);
  }
  EXPECT_EQ(kept, totals.frames);
  EXPECT_EQ(reader->end().at("lost_frames"), absl::StrCat(totals.lost_frames));
}

TEST(RecorderTest, NothingThatExistsIsWrittenOver) {
  const ScratchDir folder;
  WriteBytes(folder / "a.mcap", "precious");
  EXPECT_EQ(ReasonOf(Recorder::Create(folder / "a.mcap", {}).status()), "IO");
  EXPECT_EQ(ReasonOf(Recorder::Create(folder / "no/a.mcap", {}).status()),
            "IO");
}

TEST(RecorderTest, ARecordingWithoutAFrameIsRemoved) {
  const ScratchDir folder;
  std::FILE* const out = std::tmpfile();
  for (const bool with_frame : {false, true}) {
    const std::string path = folder / "a.mcap";
    const auto recorder = *Recorder::Create(path, {.sync = false});
    LossySkin skin(true, false);
    const SkinInfo info = *skin.Configure();
    ASSERT_TRUE(skin.Activate().ok());
    recorder->Begin(info, MakeConfig(info), {});
    SkinFrame frame;
    ASSERT_EQ(*skin.Read(frame), ReadResult::kFrame);
    if (with_frame) recorder->Frame(frame);
    EXPECT_TRUE(FinishRecorder(recorder.get(), path, out).ok());
    EXPECT_EQ(std::filesystem::exists(path), with_frame);
  }
  std::fclose(out);
}

// A file that may not grow stands for a full disk.
TEST(RecorderTest, AFullDiskEndsTheRecordingAndNotTheStream) {
  const ScratchDir folder;
  TestServer server;
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before;
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 300'000;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto recorder = *Recorder::Create(
      folder / "a.mcap", {.wait_when_full = true, .sync = false});
  SimDriver driver({.seed = 5}, 4, {});
  TrialPlayer player(server.channel(), &driver, {.recorder = recorder.get()},
                     [](const TrialResult&) {});
  const absl::Status played = player.Run();
  const absl::Status recorded = recorder->Finish();
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_TRUE(played.ok()) << played;
  EXPECT_EQ(ReasonOf(recorded), "IO") << recorded;
  EXPECT_GT(recorder->totals().lost_frames, 0U);
  EXPECT_EQ(recorder->totals().frames + recorder->totals().lost_frames,
            player.totals().frames);
  // What was written before is a recording.
  const auto reader = *RecordingReader::Open(folder / "a.mcap");
  RecordingEvent event;
  int events = 0;
  while (*reader->Next(event)) ++events;
  EXPECT_GT(events, 50);
  EXPECT_THAT(reader->CutOff(), HasSubstr("was cut off"));
}

}  // namespace
}  // namespace tactus::internal::client
