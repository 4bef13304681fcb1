// File: recording_reader.h
//
// RecordingReader: reads the events of a recording, and checks them.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto reader,
//                           RecordingReader::Open("run.mcap"));
//   RecordingEvent event;
//   while (true) {
//     TACTUS_ASSIGN_OR_RETURN(const bool more, reader->Next(event));
//     if (!more) break;
//     if (const auto* frame = std::get_if<v1::FrameBatch>(&event)) Use(*frame);
//   }
//   reader->CutOff();  // empty, or where the recording was cut off
//
// A configuration comes before the first frame; each frame has the skin's size,
// a higher sequence number and a later time than the one before. A calibration
// comes before the first raw frame, which has the size that it states, and
// number and time of the frame before it. Values and the text of the
// calibration are not checked. Other topics are passed over. Not thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/data/recording/recording.h"
#include "core/files/mcap/mcap_reader.h"
#include "core/skin/layout.h"

namespace tactus::internal {

class RecordingReader {
 public:
  // IO if the file cannot be read; TRIAL_FILE_INVALID if it is no MCAP file.
  static absl::StatusOr<std::unique_ptr<RecordingReader>> Open(
      const std::string& path);

  // Reads the next event. False at the end, also of a recording that was cut
  // off. TRIAL_FILE_INVALID, DATA_LOST for a wrong checksum, or IO.
  absl::StatusOr<bool> Next(RecordingEvent& event);

  // The metadata of the recording, and that of its end; empty before they were
  // read.
  const RecordingTexts& about() const { return about_; }
  const RecordingTexts& end() const { return end_; }
  // The configuration's skin, once it was read.
  const SkinLayout& layout() const { return *layout_; }
  // After the end: empty, or a text for people.
  std::string CutOff() const;

 private:
  RecordingReader(std::string path, std::unique_ptr<McapReader> file)
      : path_(std::move(path)), file_(std::move(file)) {}

  // What a frame must have.
  struct Sizes {
    size_t frame_bytes = 0;
    int pose_numbers = 0;
  };

  absl::Status TakeMetadata(RecordingEvent& event, bool* found);
  absl::Status TakeMessage(RecordingEvent& event, bool* found);
  // The same for the topics of a calibrated skin.
  absl::Status TakeRaw(RecordingEvent& event, bool* found);
  absl::Status TakeCalibration(RecordingEvent& event);
  template <typename Message>
  absl::Status Parse(Message& message) const;
  // Parses the message as a `Message`.
  template <typename Message>
  absl::Status ParseEvent(RecordingEvent& event) const;
  // OK and the skin if a stream may have the configuration.
  absl::StatusOr<SkinLayout> CheckConfig(const v1::StreamConfig& config,
                                         Sizes* sizes) const;
  absl::Status CheckSize(const v1::FrameBatch& frame, const Sizes& sizes) const;
  absl::Status CheckFrame(const v1::FrameBatch& frame);
  absl::Status Invalid(absl::string_view message) const;

  const std::string path_;
  const std::unique_ptr<McapReader> file_;
  RecordingTexts about_;
  RecordingTexts end_;
  std::optional<SkinLayout> layout_;
  Sizes sizes_;
  // What a calibrated skin sends, and if it is calibrated, once both topics
  // were read.
  std::optional<v1::StreamConfig> raw_config_;
  bool has_calibration_ = false;
  Sizes raw_sizes_;
  // Number and time of the last frame.
  uint64_t sequence_ = 0;
  std::optional<int64_t> time_ns_;
  // Its raw frame was read.
  bool has_raw_ = false;
};

}  // namespace tactus::internal
