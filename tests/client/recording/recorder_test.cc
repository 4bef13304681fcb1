// The recorder and its threads: frames from one, results from another, and the
// one that writes.
#include "client/recording/recorder.h"

#include <thread>

#include "core/data/recording/recording_reader.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::client {
namespace {

constexpr uint64_t kFrames = 3'000;

SkinInfo RecorderSkin() {
  SkinInfo info;
  info.layout = *LayoutPreset("vitac-12x32");
  info.layout.rows = 4;
  info.layout.columns = 4;
  return info;
}

SkinFrame RecorderFrame(uint64_t number) {
  SkinFrame frame;
  frame.capture_time_ns = static_cast<int64_t>(number) * 1'000'000;
  frame.u16.assign(16, static_cast<uint16_t>(number));
  return frame;
}

struct Counts {
  uint64_t frames = 0;
  uint64_t raw = 0;
  uint64_t results = 0;
  uint64_t calibrations = 0;
};

Counts CountEvents(const std::string& path) {
  Counts counts;
  const auto reader = *RecordingReader::Open(path);
  RecordingEvent event;
  while (true) {
    const auto more = reader->Next(event);
    EXPECT_TRUE(more.ok()) << more.status();
    if (!more.ok() || !*more) break;
    counts.frames += std::holds_alternative<v1::FrameBatch>(event);
    counts.raw += std::holds_alternative<RawFrame>(event);
    counts.results += std::holds_alternative<v1::Answer>(event);
    counts.calibrations += std::holds_alternative<RecordedCalibration>(event);
  }
  EXPECT_EQ(reader->CutOff(), "");
  return counts;
}

// Whatever the queue's size, the file and the numbers of lost events add up,
// and a raw frame is kept with its frame.
TEST(RecorderThreadsTest, FramesAndResultsOfTwoThreadsAddUp) {
  const ScratchDir folder;
  const SkinInfo info = RecorderSkin();
  v1::StreamConfig config = MakeConfig(info);
  for (const bool raw : {false, true}) {
    for (const size_t queue_bytes : {size_t{2'000}, size_t{64} << 20}) {
      for (const bool wait : {false, true}) {
        const std::string path =
            folder / absl::StrCat(raw, "-", queue_bytes, "-", wait);
        const auto recorder =
            *Recorder::Create(path, {.queue_bytes = queue_bytes,
                                     .wait_when_full = wait,
                                     .sync = false});
        recorder->Begin(info, config, {});
        if (raw) recorder->BeginRaw(info, "{}");
        recorder->BeginTrial({{"label", "HU"}});
        std::thread results([&] {
          for (uint64_t i = 1; i <= kFrames; ++i) {
            v1::Answer posterior;
            posterior.set_sequence(i);
            recorder->Result(posterior);
          }
        });
        for (uint64_t i = 1; i <= kFrames; ++i) {
          const SkinFrame frame = RecorderFrame(i);
          recorder->Frame(frame, raw ? &frame : nullptr);
        }
        recorder->EndTrial();
        results.join();
        const absl::Status finished = recorder->Finish();
        ASSERT_TRUE(finished.ok()) << finished;
        const Recorder::Totals& totals = recorder->totals();
        EXPECT_EQ(totals.frames + totals.lost_frames, kFrames);
        EXPECT_EQ(totals.results + totals.lost_results, kFrames);
        if (wait) {
          EXPECT_EQ(totals.lost_frames + totals.lost_results, 0U);
        }
        const Counts counts = CountEvents(path);
        EXPECT_EQ(counts.frames, totals.frames);
        EXPECT_EQ(counts.raw, raw ? totals.frames : 0);
        EXPECT_EQ(counts.results, totals.results);
        EXPECT_EQ(counts.calibrations, raw ? 1U : 0U);
      }
    }
  }
}

// What comes after the end, or while it comes, is lost and counted.
TEST(RecorderThreadsTest, ResultsMayComeWhileItEnds) {
  const ScratchDir folder;
  const SkinInfo info = RecorderSkin();
  const auto recorder = *Recorder::Create(folder / "a.mcap", {.sync = false});
  recorder->Begin(info, MakeConfig(info), {});
  recorder->Frame(RecorderFrame(1));
  std::atomic<bool> stop = false;
  std::thread results([&] {
    v1::Answer posterior;
    while (!stop) {
      posterior.set_sequence(posterior.sequence() + 1);
      recorder->Result(posterior);
    }
  });
  const absl::Status finished = recorder->Finish();
  stop = true;
  results.join();
  ASSERT_TRUE(finished.ok()) << finished;
  EXPECT_EQ(CountEvents(folder / "a.mcap").frames, 1U);
}

}  // namespace
}  // namespace tactus::internal::client
