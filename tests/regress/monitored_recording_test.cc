// A recording of trials that a monitor showed did not replay: its ends of
// trials were not recorded, and the replay asked for fewer answers.
#include <string>
#include <vector>

#include "client/drivers/recording_driver.h"
#include "client/drivers/sim_driver.h"
#include "client/recording/answer_check.h"
#include "client/recording/recorder.h"
#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"
#include "tests/support/scratch_dir.h"
#include "tools/stream/live_player.h"
#include "tools/stream/record_replay.h"

namespace tactus::internal::client {
namespace {

using testing::TestServer;

TEST(RegressTest, AMonitoredRecordingReplaysBitForBit) {
  class Watcher : public LiveObserver {
   public:
    void OnStarted(const SkinInfo&, const v1::StreamStarted&) override {}
    void OnFrame(const SkinFrame&, uint64_t) override {}
    void OnAnswer(const v1::Answer&) override {}
    void OnRead() override {}
  };
  const ScratchDir folder;
  const std::string path = folder / "monitored.mcap";
  TestServer server;
  Watcher watcher;
  const auto recorder =
      *Recorder::Create(path, {.about = {{"stream", "skin"}}, .sync = false});
  SimDriver sim({.seed = 5, .lead_in_frames = 20}, 3, {});
  LivePlayer player(
      server.channel(), &sim,
      {.observer = &watcher, .recorder = recorder.get(), .labelled = &sim},
      [](const LiveContact&) {}, [](const std::string&) {});
  ASSERT_TRUE(player.Run().ok());
  ASSERT_TRUE(recorder->Finish().ok());
  const auto start = ReadRecordingStart(path);
  ASSERT_TRUE(start.ok()) << start.status();
  EXPECT_EQ(start->trial.Text("label"), "HU");
  AnswerCheck check;
  RecordingDriver driver(path, {.on_event = EventsTo(check)});
  std::vector<std::string> labels;
  LivePlayer again(
      server.channel(), &driver,
      {.check = &check, .cadence = start->config.cadence()},
      [&](const LiveContact&) { labels.push_back(driver.trial().label); },
      [](const std::string&) {});
  ASSERT_TRUE(again.Run().ok());
  EXPECT_EQ(labels, (std::vector<std::string>{"HU", "HM", "SU"}));
  const AnswerCheck::Counts counts = check.Result();
  // A frame whose answer was late, then or now, has none; ends of trials have.
  // The bug left two equal answers.
  EXPECT_GT(counts.equal, 3U);
  EXPECT_EQ(counts.different, 0U) << check.Text();
}

}  // namespace
}  // namespace tactus::internal::client
