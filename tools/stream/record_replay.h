// File: record_replay.h
//
// What tactus-stream does with recordings: --record=FILE.mcap, and
// --driver=replay with such a file.
//
//   TACTUS_ASSIGN_OR_RETURN(const RecordingStart start,
//                           ReadRecordingStart("run.mcap"));
//   AnswerCheck check;
//   RecordingDriver driver("run.mcap", {.on_event = EventsTo(check)});
//   LivePlayer player(channel, &driver, {.check = &check}, ...);
//   TACTUS_RETURN_IF_ERROR(FinishRecorder(recorder.get(), path, stderr));
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/drivers/calibrated_driver.h"
#include "client/recording/answer_check.h"
#include "client/recording/recorder.h"
#include "tools/common/json.h"

namespace tactus::internal::client {

bool IsRecording(absl::string_view path);

// How a recording was made.
struct RecordingStart {
  v1::StreamConfig config;
  // True if a skin was streamed until it was stopped, without labelled trials.
  bool is_live = false;
  // Frames of one message.
  uint32_t batch = 1;
  // Names the skin; empty if it was not recorded.
  std::string device;
  // The first trial.
  RecordedTrial trial;
  // Calibration of a calibrated skin.
  std::optional<CalibrationInUse> calibration;
};

// Reads as far as the first frame. TRIAL_FILE_INVALID or IO; INVALID_CONFIG for
// a calibration that is none.
absl::StatusOr<RecordingStart> ReadRecordingStart(const std::string& path);

// How the raw frames of a recording become loads: as `options` says. What it
// leaves open is as it was when they were recorded: the device, the tare if
// there was one, and the drift if it was followed.
CalibratedDriverOptions Recalibration(const RecordingStart& start,
                                      CalibratedDriverOptions options);

// Hands what the server answered and the model's checksum to `check`, which
// outlives the result.
std::function<void(const RecordingEvent&)> EventsTo(AnswerCheck& check);

// {"equal": 40, ...}.
Json ToJson(const AnswerCheck& check);

// Completes the file `path` and prints what it holds and what was lost. A file
// without a frame, as of a stream that was refused, is removed. OK for null.
absl::Status FinishRecorder(Recorder* recorder, const std::string& path,
                            std::FILE* out);

}  // namespace tactus::internal::client
