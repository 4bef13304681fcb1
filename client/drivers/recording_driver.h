// File: recording_driver.h
//
// RecordingDriver: plays a recording (docs/formats.md, "Recordings"): the same
// frames with the same sequence numbers and capture times, so that a stream of
// the same model gives the same posteriors, bit for bit.
//
//   RecordingDriver driver("run.mcap", {.on_event = [&](const auto& event) {
//     if (const auto* p = std::get_if<v1::Answer>(&event)) Expect(*p);
//   }});
//   TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, driver.Configure());
//
// With `raw` the frames are those that the skin sent, with the poses of the
// calibrated ones. A recording of a skin without a calibration has the same
// frames either way.
//
// An open trial of a recording that was cut off ends with it. Not thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/drivers/labelled_driver.h"
#include "core/data/recording/recording_reader.h"

namespace tactus::internal::client {

class RecordingDriver : public LabelledDriver {
 public:
  struct Options {
    // Number of trials after which it ends; 0: all.
    size_t max_trials = 0;
    // True: Read returns frames at the pace of their capture times.
    bool real_time = false;
    bool raw = false;
    // Called for each event of the recording, on the thread that reads.
    std::function<void(const RecordingEvent&)> on_event = {};
  };

  RecordingDriver(std::string path, Options options)
      : path_(std::move(path)), options_(std::move(options)) {}

  const Trial& trial() const override { return trial_; }
  size_t trial_index() const override { return trials_ == 0 ? 0 : trials_ - 1; }
  // `problem` says at the end of the data whether the recording was cut off.
  DriverStatistics Statistics() const override { return statistics_; }

  // Valid after Configure: the configuration that was recorded, and metadata of
  // the recording.
  const v1::StreamConfig& config() const { return config_; }
  const RecordingTexts& about() const { return reader_->about(); }
  // Valid after Configure with `raw`: of a calibrated skin.
  const std::optional<RecordedCalibration>& calibration() const {
    return calibration_;
  }

 protected:
  // TRIAL_FILE_INVALID if the recording has no configuration.
  absl::StatusOr<SkinInfo> OnConfigure() override;
  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override;

 private:
  // True if `event` is the next one.
  absl::StatusOr<bool> NextEvent(RecordingEvent& event);
  void TakeTrial(const RecordedTrial& trial);
  // With `raw`: reads on to the calibration, or to the first frame.
  absl::Status FindCalibration();
  // The frame that `event_` is; null if it is none, or not one that is played.
  const v1::FrameBatch* PlayedFrame() const;
  void TakeFrame(const v1::FrameBatch& batch, SkinFrame& frame);
  void TakePose(const v1::FrameBatch& batch);
  // With real_time: waits a short time. True once the frame is due.
  bool IsDue(int64_t capture_time_ns);

  const std::string path_;
  const Options options_;
  std::unique_ptr<RecordingReader> reader_;
  v1::StreamConfig config_;
  std::optional<RecordedCalibration> calibration_;
  // The type of frames that are played.
  v1::TaxelType taxel_type_ = v1::TAXEL_TYPE_UINT16;
  // Pose of the last frame, and its trial.
  Pose pose_;
  Trial trial_;
  // Trials that have begun.
  size_t trials_ = 0;
  bool in_trial_ = false;
  bool at_end_ = false;
  uint64_t sequence_ = 0;
  RecordingEvent event_;
  // `event_` is a frame that was not played yet.
  bool waiting_ = false;
  // Capture time minus time of the clock; once a frame was read.
  std::optional<int64_t> offset_ns_;
  DriverStatistics statistics_;
};

}  // namespace tactus::internal::client
