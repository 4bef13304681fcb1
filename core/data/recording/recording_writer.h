// File: recording_writer.h
//
// RecordingWriter: writes the events of a stream as an MCAP file, and each
// frame also as a picture.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const auto writer,
//       RecordingWriter::Create("run.mcap", {{"driver", "sim"}}, {}));
//   TACTUS_RETURN_IF_ERROR(writer->Write(config));
//   TACTUS_RETURN_IF_ERROR(writer->Write(frame));
//   TACTUS_RETURN_IF_ERROR(writer->Finish({{"frames", "1"}}));
//
// The time of a message in the file is the capture time of its frame; before
// the first frame events wait for that frame's time. Not thread-safe.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/data/recording/foxglove_image.h"
#include "core/data/recording/recording.h"
#include "core/files/mcap/mcap_writer.h"

namespace tactus::internal {

class RecordingWriter {
 public:
  // `about` becomes metadata of the recording. IO if the file cannot be
  // created, or exists.
  static absl::StatusOr<std::unique_ptr<RecordingWriter>> Create(
      const std::string& path, const RecordingTexts& about,
      const McapWriterOptions& options);

  // The configuration comes before the first frame, and a calibration before
  // the first raw frame. INVALID_CONFIG for a frame without it, or of another
  // size.
  absl::Status Write(const RecordingEvent& event);
  // Writes what waits in the open chunk.
  absl::Status Flush();
  // `values` becomes metadata at the end. Once.
  absl::Status Finish(const RecordingTexts& values);

  uint64_t bytes() const { return file_->bytes(); }

 private:
  explicit RecordingWriter(std::unique_ptr<McapWriter> file);

  absl::Status WriteNow(const RecordingEvent& event);
  absl::Status WriteFrame(const v1::FrameBatch& frame);
  absl::Status WriteCalibration(const RecordedCalibration& calibration);
  absl::Status WriteMessage(uint16_t channel, int64_t time_ns,
                            const google::protobuf::MessageLite& message);
  absl::Status WriteWaiting();

  const std::unique_ptr<McapWriter> file_;
  const uint16_t frame_schema_;
  const uint16_t config_schema_;
  uint16_t frames_;
  uint16_t images_;
  uint16_t configs_;
  uint16_t ends_;
  uint16_t started_;
  uint16_t results_;
  // Channel of a calibrated skin's raw frames; 0 before its calibration.
  uint16_t raw_ = 0;
  v1::StreamConfig config_;
  // Once configured.
  std::optional<FoxgloveImage> image_;
  size_t frame_bytes_ = 0;
  size_t raw_bytes_ = 0;
  // Events before the first frame.
  bool has_frame_ = false;
  std::vector<RecordingEvent> waiting_;
  // Capture time of the last frame.
  int64_t time_ns_ = 0;
};

}  // namespace tactus::internal
