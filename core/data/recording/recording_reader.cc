#include "core/data/recording/recording_reader.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/skin/layout_proto.h"
#include "core/skin/taxel_values.h"

namespace tactus::internal {
namespace {

// x y z qx qy qz qw.
constexpr int kPoseNumbers = 7;

constexpr absl::string_view kNoRecording =
    "is an MCAP file, but no recording of tactus-stream; trainctl import makes "
    "a trial file, which can be replayed, of a bag of ROS 2";

}  // namespace

absl::StatusOr<std::unique_ptr<RecordingReader>> RecordingReader::Open(
    const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(auto file, McapReader::Open(path));
  return std::unique_ptr<RecordingReader>(
      new RecordingReader(path, std::move(file)));
}

absl::StatusOr<bool> RecordingReader::Next(RecordingEvent& event) {
  bool found = false;
  while (!found) {
    TACTUS_ASSIGN_OR_RETURN(const McapRead read, file_->Next());
    if (read == McapRead::kEnd) {
      if (about_.empty() && file_->complete()) {
        return TrialFileInvalid(path_, kNoRecording);
      }
      return false;
    }
    TACTUS_RETURN_IF_ERROR(read == McapRead::kMetadata
                               ? TakeMetadata(event, &found)
                               : TakeMessage(event, &found));
  }
  return true;
}

std::string RecordingReader::CutOff() const {
  if (file_->complete()) return "";
  return absl::StrCat(path_, " was cut off or its end is damaged: of its ",
                      file_->file_bytes(), " bytes the first ",
                      file_->complete_bytes(), " were read");
}

absl::Status RecordingReader::TakeMetadata(RecordingEvent& event, bool* found) {
  const McapMetadata& metadata = file_->metadata();
  if (metadata.name == kRecordingMetadata) {
    const RecordedTrial about{metadata.values};
    if (about.Text("format") != kRecordingFormat ||
        about.Text("version") != kRecordingVersion) {
      return TrialFileInvalid(
          path_, absl::StrCat("has the format ", Quoted(about.Text("format")),
                              ", version ", Quoted(about.Text("version")),
                              "; it must be ", kRecordingFormat, ", version ",
                              kRecordingVersion));
    }
    about_ = metadata.values;
  } else if (metadata.name == kEndMetadata) {
    end_ = metadata.values;
  } else if (metadata.name == kTrialMetadata && !about_.empty()) {
    event = RecordedTrial{metadata.values};
    *found = true;
  }
  return absl::OkStatus();
}

absl::Status RecordingReader::TakeMessage(RecordingEvent& event, bool* found) {
  const std::string& topic = file_->message().channel->topic;
  *found = true;
  if (about_.empty()) {
    return TrialFileInvalid(path_, kNoRecording);
  }
  if (topic == kFrameTopic) {
    TACTUS_RETURN_IF_ERROR(ParseEvent<v1::FrameBatch>(event));
    return CheckFrame(std::get<v1::FrameBatch>(event));
  }
  if (topic == kResultTopic) return ParseEvent<v1::Answer>(event);
  if (topic == kEndOfTrialTopic) return ParseEvent<v1::EndOfTrial>(event);
  if (topic == kStartedTopic) return ParseEvent<v1::StreamStarted>(event);
  if (topic == kConfigTopic) {
    TACTUS_RETURN_IF_ERROR(ParseEvent<v1::StreamConfig>(event));
    if (layout_) return Invalid("is a second configuration");
    TACTUS_ASSIGN_OR_RETURN(
        layout_, CheckConfig(std::get<v1::StreamConfig>(event), &sizes_));
    return absl::OkStatus();
  }
  return TakeRaw(event, found);
}

absl::Status RecordingReader::TakeRaw(RecordingEvent& event, bool* found) {
  const std::string& topic = file_->message().channel->topic;
  *found = false;
  if (topic == kRawConfigTopic) {
    if (raw_config_) return Invalid("is a second configuration");
    raw_config_.emplace();
    TACTUS_RETURN_IF_ERROR(Parse(*raw_config_));
    return CheckConfig(*raw_config_, &raw_sizes_).status();
  }
  *found = true;
  if (topic == kCalibrationTopic) return TakeCalibration(event);
  if (topic == kRawTopic) {
    if (!std::holds_alternative<RawFrame>(event)) event = RawFrame();
    v1::FrameBatch& batch = std::get<RawFrame>(event).batch;
    TACTUS_RETURN_IF_ERROR(Parse(batch));
    if (!has_calibration_) return Invalid("comes before the calibration");
    TACTUS_RETURN_IF_ERROR(CheckSize(batch, raw_sizes_));
    if (!time_ns_ || has_raw_ || batch.first_sequence() != sequence_ ||
        batch.first_capture_time_ns() != *time_ns_) {
      return Invalid("must be what the skin sent for the frame before it");
    }
    has_raw_ = true;
    return absl::OkStatus();
  }
  *found = false;
  return absl::OkStatus();
}

absl::Status RecordingReader::TakeCalibration(RecordingEvent& event) {
  const McapMessage& message = file_->message();
  if (message.channel->message_encoding != "json") {
    return Invalid("must be JSON");
  }
  if (!raw_config_ || has_calibration_) {
    return Invalid(has_calibration_ ? "is a second calibration"
                                    : "comes before its configuration");
  }
  has_calibration_ = true;
  event = RecordedCalibration{*raw_config_, std::string(message.data)};
  return absl::OkStatus();
}

template <typename Message>
absl::Status RecordingReader::Parse(Message& parsed) const {
  const McapMessage& message = file_->message();
  const std::string& name = Message::descriptor()->full_name();
  if (message.schema == nullptr || message.schema->name != name ||
      message.channel->message_encoding != "protobuf") {
    return Invalid(absl::StrCat("must be a ", name, " in protobuf"));
  }
  if (!parsed.ParseFromArray(message.data.data(),
                             static_cast<int>(message.data.size()))) {
    return Invalid(absl::StrCat("is no ", name));
  }
  return absl::OkStatus();
}

template <typename Message>
absl::Status RecordingReader::ParseEvent(RecordingEvent& event) const {
  if (!std::holds_alternative<Message>(event)) event = Message();
  return Parse(std::get<Message>(event));
}

absl::StatusOr<SkinLayout> RecordingReader::CheckConfig(
    const v1::StreamConfig& config, Sizes* sizes) const {
  auto layout = LayoutFromProto(config.geometry());
  if (!layout.ok()) return Invalid(layout.status().message());
  const double rate = config.sample_rate_hz();
  // Written so that NaN is refused.
  if (config.has_sample_rate_hz() &&
      !(rate >= limits::kMinSampleRateHz && rate <= limits::kMaxSampleRateHz)) {
    return Invalid(absl::StrCat("has the sample_rate_hz ", rate));
  }
  if (config.has_scale() &&
      !(std::isfinite(config.scale()) && config.scale() > 0)) {
    return Invalid(absl::StrCat("has the scale ", config.scale()));
  }
  if (config.release_after_ms() > limits::kMaxReleaseAfterMs) {
    return Invalid(
        absl::StrCat("has the release_after_ms ", config.release_after_ms()));
  }
  const size_t value = TaxelBytes(config.taxel_type());
  if (value == 0) return Invalid("has an unknown type of taxels");
  *sizes = {static_cast<size_t>(layout->values()) * value,
            config.with_poses() ? kPoseNumbers : 0};
  return *std::move(layout);
}

absl::Status RecordingReader::CheckSize(const v1::FrameBatch& frame,
                                        const Sizes& sizes) const {
  if (frame.frame_count() != 1 || frame.has_sparse()) {
    return Invalid("must have one dense frame");
  }
  if (frame.taxels().size() != sizes.frame_bytes) {
    return Invalid(absl::StrCat("has ", frame.taxels().size(),
                                " bytes of taxels; the skin has ",
                                sizes.frame_bytes));
  }
  if (frame.poses_size() != sizes.pose_numbers) {
    return Invalid(absl::StrCat("has ", frame.poses_size(),
                                " numbers of poses; it must have ",
                                sizes.pose_numbers));
  }
  return absl::OkStatus();
}

absl::Status RecordingReader::CheckFrame(const v1::FrameBatch& frame) {
  if (!layout_) return Invalid("is a frame before the configuration");
  TACTUS_RETURN_IF_ERROR(CheckSize(frame, sizes_));
  const int64_t time = frame.first_capture_time_ns();
  if (time > limits::kMaxCaptureTimeNs || time < -limits::kMaxCaptureTimeNs ||
      (time_ns_ && time <= *time_ns_)) {
    return Invalid(absl::StrCat("has the capture time ", time,
                                " ns, which is not above the one before"));
  }
  if (frame.first_sequence() <= sequence_) {
    return Invalid(absl::StrCat("has the sequence number ",
                                frame.first_sequence(),
                                ", which is not above the one before"));
  }
  time_ns_ = time;
  sequence_ = frame.first_sequence();
  has_raw_ = false;
  return absl::OkStatus();
}

absl::Status RecordingReader::Invalid(absl::string_view message) const {
  return TrialFileInvalid(
      path_,
      absl::StrCat("message ", file_->message().sequence, " of ",
                   Printable(file_->message().channel->topic), " ", message));
}

}  // namespace tactus::internal
