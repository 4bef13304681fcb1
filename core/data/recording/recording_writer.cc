#include "core/data/recording/recording_writer.h"

#include <algorithm>
#include <utility>

#include "core/base/errors.h"
#include "core/base/serialize.h"
#include "core/base/status_macros.h"
#include "core/data/recording/message_schema.h"
#include "core/skin/layout_proto.h"
#include "core/skin/taxel_values.h"

namespace tactus::internal {
namespace {

template <typename Message>
uint16_t AddMessage(McapWriter& file) {
  return file.AddSchema(MessageSchema(*Message::descriptor()));
}

uint16_t AddTopic(const char* topic, uint16_t schema, McapWriter& file) {
  return file.AddChannel({schema, topic, "protobuf", {}});
}

template <typename Message>
uint16_t AddTopic(const char* topic, McapWriter& file) {
  return AddTopic(topic, AddMessage<Message>(file), file);
}

// Bytes of a frame of a stream with this configuration and this skin.
size_t FrameBytes(const v1::StreamConfig& config, const SkinLayout& layout) {
  return static_cast<size_t>(layout.values()) * TaxelBytes(config.taxel_type());
}

// `bytes` is 0 before the configuration.
absl::Status CheckSize(const v1::FrameBatch& frame, size_t bytes) {
  if (bytes > 0 && frame.frame_count() == 1 && frame.taxels().size() == bytes) {
    return absl::OkStatus();
  }
  return InvalidConfig("bytes of a recorded frame", frame.taxels().size(),
                       absl::StrCat(bytes));
}

}  // namespace

absl::StatusOr<std::unique_ptr<RecordingWriter>> RecordingWriter::Create(
    const std::string& path, const RecordingTexts& about,
    const McapWriterOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(auto file, McapWriter::Create(path, options));
  std::unique_ptr<RecordingWriter> writer(new RecordingWriter(std::move(file)));
  RecordingTexts values = about;
  values.insert_or_assign("format", std::string(kRecordingFormat));
  values.insert_or_assign("version", std::string(kRecordingVersion));
  TACTUS_RETURN_IF_ERROR(
      writer->file_->WriteMetadata({kRecordingMetadata, values}));
  return writer;
}

RecordingWriter::RecordingWriter(std::unique_ptr<McapWriter> file)
    : file_(std::move(file)),
      frame_schema_(AddMessage<v1::FrameBatch>(*file_)),
      config_schema_(AddMessage<v1::StreamConfig>(*file_)),
      frames_(AddTopic(kFrameTopic, frame_schema_, *file_)),
      images_(file_->AddChannel({file_->AddSchema(FoxgloveImage::Schema()),
                                 kImageTopic,
                                 "protobuf",
                                 {}})),
      configs_(AddTopic(kConfigTopic, config_schema_, *file_)),
      ends_(AddTopic<v1::EndOfTrial>(kEndOfTrialTopic, *file_)),
      started_(AddTopic<v1::StreamStarted>(kStartedTopic, *file_)),
      results_(AddTopic<v1::Answer>(kResultTopic, *file_)) {}

absl::Status RecordingWriter::Write(const RecordingEvent& event) {
  const auto* frame = std::get_if<v1::FrameBatch>(&event);
  if (const auto* config = std::get_if<v1::StreamConfig>(&event)) {
    TACTUS_ASSIGN_OR_RETURN(SkinLayout layout,
                            LayoutFromProto(config->geometry()));
    config_ = *config;
    frame_bytes_ = FrameBytes(*config, layout);
    image_.emplace(std::move(layout));
  }
  if (const auto* raw = std::get_if<RecordedCalibration>(&event)) {
    TACTUS_ASSIGN_OR_RETURN(const SkinLayout layout,
                            LayoutFromProto(raw->raw.geometry()));
    raw_bytes_ = FrameBytes(raw->raw, layout);
  }
  if (const auto* raw = std::get_if<RawFrame>(&event)) {
    TACTUS_RETURN_IF_ERROR(CheckSize(raw->batch, raw_bytes_));
  }
  if (frame != nullptr) {
    TACTUS_RETURN_IF_ERROR(CheckSize(*frame, frame_bytes_));
    time_ns_ = frame->first_capture_time_ns();
    if (!has_frame_) {
      has_frame_ = true;
      TACTUS_RETURN_IF_ERROR(WriteWaiting());
    }
  } else if (!has_frame_) {
    waiting_.push_back(event);
    return absl::OkStatus();
  }
  return WriteNow(event);
}

absl::Status RecordingWriter::WriteWaiting() {
  for (const RecordingEvent& event : std::exchange(waiting_, {})) {
    TACTUS_RETURN_IF_ERROR(WriteNow(event));
  }
  return absl::OkStatus();
}

absl::Status RecordingWriter::WriteNow(const RecordingEvent& event) {
  if (const auto* frame = std::get_if<v1::FrameBatch>(&event)) {
    return WriteFrame(*frame);
  }
  if (const auto* result = std::get_if<v1::Answer>(&event)) {
    return WriteMessage(results_, result->capture_time_ns(), *result);
  }
  if (const auto* trial = std::get_if<RecordedTrial>(&event)) {
    return file_->WriteMetadata({kTrialMetadata, trial->values});
  }
  if (const auto* config = std::get_if<v1::StreamConfig>(&event)) {
    return WriteMessage(configs_, time_ns_, *config);
  }
  if (const auto* started = std::get_if<v1::StreamStarted>(&event)) {
    return WriteMessage(started_, time_ns_, *started);
  }
  if (const auto* calibration = std::get_if<RecordedCalibration>(&event)) {
    return WriteCalibration(*calibration);
  }
  if (const auto* raw = std::get_if<RawFrame>(&event)) {
    return WriteMessage(raw_, time_ns_, raw->batch);
  }
  return WriteMessage(ends_, time_ns_, v1::EndOfTrial());
}

absl::Status RecordingWriter::WriteCalibration(
    const RecordedCalibration& calibration) {
  raw_ = AddTopic(kRawTopic, frame_schema_, *file_);
  const uint16_t config = AddTopic(kRawConfigTopic, config_schema_, *file_);
  const uint16_t json =
      file_->AddChannel({file_->AddSchema(JsonSchema("tactus.Calibration")),
                         kCalibrationTopic,
                         "json",
                         {}});
  TACTUS_RETURN_IF_ERROR(WriteMessage(config, time_ns_, calibration.raw));
  return file_->Write(json,
                      static_cast<uint64_t>(std::max<int64_t>(time_ns_, 0)),
                      calibration.json);
}

absl::Status RecordingWriter::WriteFrame(const v1::FrameBatch& frame) {
  TACTUS_RETURN_IF_ERROR(WriteMessage(frames_, time_ns_, frame));
  const double scale = config_.has_scale() ? config_.scale() : 1;
  return file_->Write(images_,
                      static_cast<uint64_t>(std::max<int64_t>(time_ns_, 0)),
                      image_->Encode(frame, config_.taxel_type(), scale));
}

absl::Status RecordingWriter::WriteMessage(
    uint16_t channel, int64_t time_ns,
    const google::protobuf::MessageLite& message) {
  // The file has no times before 1970; the message itself keeps its own.
  return file_->Write(channel,
                      static_cast<uint64_t>(std::max<int64_t>(time_ns, 0)),
                      SerializeDeterministic(message));
}

absl::Status RecordingWriter::Flush() { return file_->Flush(); }

absl::Status RecordingWriter::Finish(const RecordingTexts& values) {
  TACTUS_RETURN_IF_ERROR(WriteWaiting());
  TACTUS_RETURN_IF_ERROR(file_->WriteMetadata({kEndMetadata, values}));
  return file_->Finish();
}

}  // namespace tactus::internal
