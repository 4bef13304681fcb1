#include "client/drivers/recording_driver.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>
#include <thread>

#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/skin/layout_proto.h"

namespace tactus::internal::client {
namespace {

static_assert(std::endian::native == std::endian::little,
              "values are copied from the wire as they are");

// The longest that Read waits.
constexpr std::chrono::milliseconds kWait(100);

template <typename Value>
void CopyTaxels(const std::string& bytes, std::vector<Value>& values) {
  values.resize(bytes.size() / sizeof(Value));
  std::memcpy(values.data(), bytes.data(), bytes.size());
}

}  // namespace

absl::StatusOr<SkinInfo> RecordingDriver::OnConfigure() {
  TACTUS_ASSIGN_OR_RETURN(reader_, RecordingReader::Open(path_));
  statistics_.connected = true;
  while (true) {
    TACTUS_ASSIGN_OR_RETURN(const bool more, NextEvent(event_));
    if (!more) {
      return TrialFileInvalid(path_, "is a recording without a frame");
    }
    if (const auto* trial = std::get_if<RecordedTrial>(&event_)) {
      TakeTrial(*trial);
    }
    if (const auto* config = std::get_if<v1::StreamConfig>(&event_)) {
      config_ = *config;
      break;
    }
  }
  if (options_.raw) TACTUS_RETURN_IF_ERROR(FindCalibration());
  const v1::StreamConfig& played = calibration_ ? calibration_->raw : config_;
  SkinInfo info;
  info.layout = reader_->layout();
  if (calibration_) {
    TACTUS_ASSIGN_OR_RETURN(info.layout, LayoutFromProto(played.geometry()));
  }
  info.taxel_type = played.taxel_type();
  info.scale = played.has_scale() ? played.scale() : 1;
  info.sample_rate_hz =
      played.has_sample_rate_hz() ? played.sample_rate_hz() : 100;
  info.with_poses = config_.with_poses();
  taxel_type_ = info.taxel_type;
  return info;
}

absl::Status RecordingDriver::FindCalibration() {
  while (true) {
    TACTUS_ASSIGN_OR_RETURN(const bool more, NextEvent(event_));
    if (!more) {
      return TrialFileInvalid(path_, "is a recording without a frame");
    }
    if (const auto* trial = std::get_if<RecordedTrial>(&event_)) {
      TakeTrial(*trial);
    }
    if (const auto* found = std::get_if<RecordedCalibration>(&event_)) {
      calibration_ = *found;
      return absl::OkStatus();
    }
    if (std::holds_alternative<v1::FrameBatch>(event_)) {
      waiting_ = true;
      return absl::OkStatus();
    }
  }
}

const v1::FrameBatch* RecordingDriver::PlayedFrame() const {
  if (calibration_) {
    const auto* raw = std::get_if<RawFrame>(&event_);
    return raw != nullptr ? &raw->batch : nullptr;
  }
  return std::get_if<v1::FrameBatch>(&event_);
}

absl::StatusOr<bool> RecordingDriver::NextEvent(RecordingEvent& event) {
  TACTUS_ASSIGN_OR_RETURN(const bool more, reader_->Next(event));
  if (more && options_.on_event) options_.on_event(event);
  return more;
}

absl::StatusOr<ReadResult> RecordingDriver::OnRead(SkinFrame& frame) {
  while (!at_end_) {
    if (!waiting_) {
      TACTUS_ASSIGN_OR_RETURN(const bool more, NextEvent(event_));
      if (!more) {
        at_end_ = true;
        statistics_.problem = reader_->CutOff();
        break;
      }
    }
    if (const auto* calibrated = std::get_if<v1::FrameBatch>(&event_)) {
      TakePose(*calibrated);
    }
    if (const auto* trial = std::get_if<RecordedTrial>(&event_)) {
      TakeTrial(*trial);
    } else if (const v1::FrameBatch* batch = PlayedFrame()) {
      waiting_ = !IsDue(batch->first_capture_time_ns());
      if (waiting_) return ReadResult::kNoFrame;
      TakeFrame(*batch, frame);
      in_trial_ = true;
      return ReadResult::kFrame;
    } else if (std::holds_alternative<v1::EndOfTrial>(event_) && in_trial_) {
      in_trial_ = false;
      // Results of this trial may follow in the file; they are passed on with
      // the next Read.
      return ReadResult::kEndOfTrial;
    }
    if (options_.max_trials > 0 && !in_trial_ &&
        trials_ > options_.max_trials) {
      --trials_;
      at_end_ = true;
    }
  }
  if (!in_trial_) return ReadResult::kEndOfData;
  in_trial_ = false;
  return ReadResult::kEndOfTrial;
}

void RecordingDriver::TakeTrial(const RecordedTrial& trial) {
  ++trials_;
  if (options_.max_trials > 0 && trials_ > options_.max_trials) return;
  trial_.id = trial.Text("id");
  trial_.label = trial.Text("label");
  trial_.condition = trial.Text("condition");
  trial_.object = trial.Text("object");
  trial_.material = trial.Text("material");
}

void RecordingDriver::TakeFrame(const v1::FrameBatch& batch, SkinFrame& frame) {
  frame.capture_time_ns = batch.first_capture_time_ns();
  frame.missing_before = batch.first_sequence() - sequence_ - 1;
  sequence_ = batch.first_sequence();
  if (taxel_type_ == v1::TAXEL_TYPE_UINT16) {
    CopyTaxels(batch.taxels(), frame.u16);
  } else if (taxel_type_ == v1::TAXEL_TYPE_INT16) {
    CopyTaxels(batch.taxels(), frame.i16);
  } else {
    CopyTaxels(batch.taxels(), frame.f32);
  }
  ++statistics_.frames;
  statistics_.lost += frame.missing_before;
  if (config_.with_poses()) frame.pose = pose_;
}

void RecordingDriver::TakePose(const v1::FrameBatch& batch) {
  if (!config_.with_poses()) return;
  const auto& p = batch.poses();
  pose_.position = {p[0], p[1], p[2]};
  pose_.orientation = Eigen::Quaterniond(p[6], p[3], p[4], p[5]);
}

bool RecordingDriver::IsDue(int64_t capture_time_ns) {
  if (!options_.real_time) return true;
  using std::chrono::nanoseconds;
  using std::chrono::steady_clock;
  const int64_t now_ns =
      nanoseconds(steady_clock::now().time_since_epoch()).count();
  if (!offset_ns_) offset_ns_ = capture_time_ns - now_ns;
  const nanoseconds left(capture_time_ns - *offset_ns_ - now_ns);
  if (left > nanoseconds(0)) {
    std::this_thread::sleep_for(std::min<nanoseconds>(left, kWait));
  }
  return left <= kWait;
}

}  // namespace tactus::internal::client
