#include "tools/stream/record_replay.h"

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/data/recording/recording_reader.h"

namespace tactus::internal::client {

bool IsRecording(absl::string_view path) {
  return absl::EndsWith(path, ".mcap");
}

absl::StatusOr<RecordingStart> ReadRecordingStart(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const auto reader, RecordingReader::Open(path));
  RecordingStart start;
  RecordingEvent event;
  while (true) {
    TACTUS_ASSIGN_OR_RETURN(const bool more, reader->Next(event));
    if (!more) {
      return TrialFileInvalid(path, "is a recording without a frame");
    }
    if (const auto* config = std::get_if<v1::StreamConfig>(&event)) {
      start.config = *config;
    } else if (const auto* trial = std::get_if<RecordedTrial>(&event)) {
      start.trial = *trial;
    } else if (const auto* raw = std::get_if<RecordedCalibration>(&event)) {
      auto in_use = CalibrationInUseFromJson(raw->json);
      if (!in_use.ok()) return Annotate(in_use.status(), path);
      start.calibration = *std::move(in_use);
    } else if (std::holds_alternative<v1::FrameBatch>(event)) {
      break;
    }
  }
  const RecordedTrial about{reader->about()};
  start.is_live = about.Text("stream") == "skin";
  start.device = about.Text("device");
  if (!absl::SimpleAtoi(about.Text("batch"), &start.batch) ||
      start.batch == 0 || start.batch > limits::kMaxFramesPerMessage) {
    start.batch = 1;
  }
  return start;
}

CalibratedDriverOptions Recalibration(const RecordingStart& start,
                                      CalibratedDriverOptions options) {
  if (options.device.empty()) options.device = start.device;
  if (!start.calibration) return options;
  if (options.tare_frames == 0) options.tare = start.calibration->tare;
  if (options.drift_time_s == 0 && options.calibration) {
    options.drift_time_s = start.calibration->drift_time_s;
  }
  return options;
}

std::function<void(const RecordingEvent&)> EventsTo(AnswerCheck& check) {
  return [&check](const RecordingEvent& event) {
    if (const auto* answer = std::get_if<v1::Answer>(&event)) {
      check.Expect(*answer);
    } else if (const auto* started = std::get_if<v1::StreamStarted>(&event)) {
      check.ExpectModel(started->bundle_sha256());
    }
  };
}

Json ToJson(const AnswerCheck& check) {
  const AnswerCheck::Counts counts = check.Result();
  return {{"same_model", check.SameModel()},
          {"equal", counts.equal},
          {"different", counts.different},
          {"only_recorded", counts.only_recorded},
          {"only_received", counts.only_received}};
}

absl::Status FinishRecorder(Recorder* recorder, const std::string& path,
                            std::FILE* out) {
  if (recorder == nullptr) return absl::OkStatus();
  const absl::Status status = recorder->Finish();
  const Recorder::Totals& totals = recorder->totals();
  if (totals.frames + totals.lost_frames == 0) {
    std::remove(path.c_str());
    std::fprintf(out, "nothing was recorded\n");
    return status;
  }
  const auto number = [](uint64_t value) {
    return static_cast<unsigned long long>(value);
  };
  std::fprintf(out, "recorded %llu frames and %llu results",
               number(totals.frames), number(totals.results));
  if (totals.lost_frames + totals.lost_results > 0) {
    std::fprintf(out, "; LOST %llu frames and %llu results",
                 number(totals.lost_frames), number(totals.lost_results));
  }
  std::fprintf(out, "\n");
  return status;
}

}  // namespace tactus::internal::client
