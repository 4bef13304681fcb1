// File: record_replay.h
//
// What tactus-stream does with recordings: --record=FILE.mcap, and
// --driver=replay with such a file.
//
//   TACTUS_ASSIGN_OR_RETURN(const RecordingStart start,
//                           ReadRecordingStart("run.mcap"));
//   PosteriorCheck check;
//   RecordingDriver driver("run.mcap", {.on_event = EventsTo(check)});
//   LivePlayer player(channel, &driver, {.check = &check}, ...);
//   TACTUS_RETURN_IF_ERROR(FinishRecorder(recorder.get(), path, stderr));
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/recording/posterior_check.h"
#include "client/recording/recorder.h"
#include "client/tools/json.h"

namespace tactus::client {

bool IsRecording(absl::string_view path);

// How a recording was made.
struct RecordingStart {
  v1::StreamConfig config;
  // Of a skin that was streamed until it was stopped, not of labelled trials.
  bool is_live = false;
  // Frames of one message.
  uint32_t batch = 1;
  // The first trial.
  RecordedTrial trial;
};

// Reads as far as the first frame. TRIAL_FILE_INVALID or IO.
absl::StatusOr<RecordingStart> ReadRecordingStart(const std::string& path);

// Hands what the server answered and the model's checksum to `check`, which
// outlives the result.
std::function<void(const RecordingEvent&)> EventsTo(PosteriorCheck& check);

// {"equal": 40, ...}.
Json ToJson(const PosteriorCheck& check);

// Completes the file `path` and prints what it holds and what was lost. A file
// without a frame, as of a stream that was refused, is removed. OK for null.
absl::Status FinishRecorder(Recorder* recorder, const std::string& path,
                            std::FILE* out);

}  // namespace tactus::client
