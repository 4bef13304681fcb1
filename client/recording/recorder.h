// File: recorder.h
//
// Recorder: records a stream to a file (docs/formats.md, "Recordings") in a
// separate thread, so that the stream never waits for a disk.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const auto recorder,
//       Recorder::Create("run.mcap", {.about = {{"driver", "sim"}}}));
//   recorder->Begin(info, config, stream->started());
//   recorder->BeginTrial({{"label", "HU"}});
//   recorder->Frame(frame);     // as the driver returned it
//   recorder->Result(answer);
//   recorder->EndTrial();
//   TACTUS_RETURN_IF_ERROR(recorder->Finish());
//
// Frames of a calibrated skin are recorded as the stream gets them and as the
// skin sent them: BeginRaw, then Frame(frame, &calibrated_driver.raw()).
//
// Events wait in a queue of bounded size. If it is full, the event is dropped
// and counted, or with `wait_when_full` the caller waits. The numbers of
// dropped events are in the file's last metadata and in totals(). A chunk of
// the file is closed at least once per second while events come, and after a
// second without any. If the disk fails, the stream goes on and Finish returns
// the error.
//
// Result may be called from any thread; the other functions belong to one.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/drivers/labelled_driver.h"
#include "client/stream/frame_encoder.h"
#include "core/data/recording/recording_writer.h"

namespace tactus::internal::client {

class Recorder {
 public:
  struct Options {
    // Metadata of the recording; each trial has it too.
    RecordingTexts about = {};
    // Size of the queue.
    size_t queue_bytes = 64UL * 1024 * 1024;
    bool wait_when_full = false;
    // Each chunk is on the disk before the next one begins.
    bool sync = true;
  };
  struct Totals {
    uint64_t frames = 0;
    uint64_t lost_frames = 0;
    uint64_t results = 0;
    uint64_t lost_results = 0;
  };

  // IO if the file cannot be created, or exists.
  static absl::StatusOr<std::unique_ptr<Recorder>> Create(
      const std::string& path, const Options& options);
  // Finishes the file.
  ~Recorder();

  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // Once: what the stream was opened with, and the server's answer.
  void Begin(const SkinInfo& info, const v1::StreamConfig& config,
             const v1::StreamStarted& started);
  // Once, before the first frame, if raw frames follow: what they are like, and
  // how loads are made of them, as JSON (calibration_in_use.h).
  void BeginRaw(const SkinInfo& raw_info, std::string calibration_json);
  // `values` describes the trial of the frames that follow.
  void BeginTrial(RecordingTexts values);
  // The trial that the driver plays.
  void BeginTrial(const LabelledDriver& driver);
  // `frame.missing_before` frames are missing in the recording too. `raw` is
  // the same frame as the skin sent it; kept or lost with it.
  void Frame(const SkinFrame& frame, const SkinFrame* raw = nullptr);
  void EndTrial();
  void Result(const v1::Answer& answer);
  // Writes what waits and completes the file. Further calls return the same.
  absl::Status Finish();

  // Valid after Finish; without results that came after it.
  const Totals& totals() const { return final_totals_; }

 private:
  struct Entry {
    RecordingEvent event;
    std::optional<RawFrame> raw;
    size_t bytes = 0;
  };

  Recorder(std::unique_ptr<RecordingWriter> writer, const Options& options);

  // False if the event was dropped. Events that `must` be kept never are.
  bool Push(RecordingEvent event, size_t bytes, bool must,
            std::optional<RawFrame> raw = std::nullopt);
  absl::Status Write(const Entry& entry);
  void WriteAll();

  const std::unique_ptr<RecordingWriter> writer_;
  const Options options_;
  std::optional<FrameEncoder> encoder_;
  std::optional<FrameEncoder> raw_encoder_;
  RecordingTexts model_;
  bool finished_ = false;
  Totals final_totals_;
  absl::Status final_status_;
  std::thread thread_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Entry> queue_;
  size_t queued_bytes_ = 0;
  bool stop_ = false;
  Totals totals_;
  // The first error of the file.
  absl::Status status_;
};

}  // namespace tactus::internal::client
