#include "client/drivers/hardware_driver.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

// A taxel that reads one value for this long is stuck.
constexpr int64_t kStuckNs = 10'000'000'000;
constexpr int64_t kSilentPeriods = 5;

}  // namespace

HardwareDriver::HardwareDriver(SkinDevice* device,
                               const HardwareDriverOptions& options,
                               Clock* clock)
    : device_(device), options_(options), clock_(clock) {}

HardwareDriver::~HardwareDriver() { Finalise().IgnoreError(); }

absl::StatusOr<SkinInfo> HardwareDriver::OnConfigure() {
  TACTUS_RETURN_IF_ERROR(device_->Open());
  auto info = device_->Setup(*clock_);
  if (!info.ok()) {
    device_->Close();
    return info;
  }
  info_ = *info;
  info_.with_poses = static_cast<bool>(options_.pose_at);
  open_ = true;
  return info_;
}

absl::Status HardwareDriver::OnActivate() {
  if (!open_) {
    TACTUS_RETURN_IF_ERROR(device_->Open());
    open_ = true;
  }
  TACTUS_RETURN_IF_ERROR(device_->Start());
  if (!meter_) {
    meter_.emplace(device_->period_ns());
    loads_.emplace(info_.layout);
    stuck_.emplace(static_cast<uint32_t>(
        std::max<int64_t>(2, kStuckNs / device_->period_ns())));
  }
  meter_->Pause();
  connected_ = true;
  attempts_ = 0;
  without_pose_since_ns_ = 0;
  last_frame_ns_ = quiet_since_ns_ = clock_->NowNs();
  return absl::OkStatus();
}

absl::Status HardwareDriver::OnDeactivate() {
  const bool reachable = open_ && connected_;
  connected_ = false;
  return reachable ? device_->Stop() : absl::OkStatus();
}

absl::Status HardwareDriver::OnFinalise() {
  device_->Close();
  open_ = false;
  return absl::OkStatus();
}

void HardwareDriver::Break(absl::string_view problem) {
  problem_ = std::string(problem);
  connected_ = false;
  without_pose_since_ns_ = 0;
  // The pause grows until a frame comes.
  pause_ns_ = attempts_ == 0
                  ? options_.first_pause_ns
                  : std::min(2 * pause_ns_, options_.longest_pause_ns);
  next_attempt_ns_ = clock_->NowNs() + pause_ns_;
}

absl::Status HardwareDriver::TryToReconnect() {
  device_->Close();
  open_ = false;
  TACTUS_RETURN_IF_ERROR(device_->Open());
  open_ = true;
  // At first as it was configured, because configuring takes what the skin
  // feels now for untouched.
  if (attempts_ > 1) {
    TACTUS_ASSIGN_OR_RETURN(SkinInfo info, device_->Setup(*clock_));
    info.with_poses = info_.with_poses;
    if (info != info_) {
      failed_ =
          IoError(device_->name(),
                  absl::StrCat("the skin has come back with other taxels (",
                               device_->Remarks(), "): begin a new stream"));
      return failed_;
    }
  }
  return device_->Start();
}

void HardwareDriver::Reconnect() {
  ++attempts_;
  if (const absl::Status status = TryToReconnect(); !status.ok()) {
    return Break(status.message());
  }
  connected_ = true;
  quiet_since_ns_ = clock_->NowNs();
}

void HardwareDriver::WaitForConnection(int64_t deadline_ns) {
  const int64_t now_ns = clock_->NowNs();
  if (now_ns >= next_attempt_ns_) return Reconnect();
  clock_->SleepNs(std::min(deadline_ns, next_attempt_ns_) - now_ns);
}

absl::StatusOr<ReadResult> HardwareDriver::OnRead(SkinFrame& frame) {
  const int64_t deadline_ns = clock_->NowNs() + options_.read_timeout_ns;
  // Slow skins are not silent between two frames.
  const int64_t silence_ns =
      std::max(options_.silence_ns, kSilentPeriods * device_->period_ns());
  for (int64_t now_ns = clock_->NowNs(); now_ns < deadline_ns;
       now_ns = clock_->NowNs()) {
    if (!failed_.ok()) return failed_;
    if (options_.give_up_ns > 0 &&
        now_ns - last_frame_ns_ > options_.give_up_ns) {
      failed_ = IoError(
          device_->name(),
          absl::StrCat(
              "no frame for ", static_cast<double>(options_.give_up_ns) / 1e9,
              " s: ", problem_.empty() ? device_->Missing() : problem_));
      return failed_;
    }
    if (options_.give_up_ns > 0 && without_pose_since_ns_ > 0 &&
        now_ns - without_pose_since_ns_ > options_.give_up_ns) {
      failed_ =
          IoError(device_->name(),
                  absl::StrCat("frames come, but no poses for ",
                               static_cast<double>(options_.give_up_ns) / 1e9,
                               " s: ", PoseProblem()));
      return failed_;
    }
    if (!connected_) {
      WaitForConnection(deadline_ns);
      continue;
    }
    const int64_t silence_end_ns = quiet_since_ns_ + silence_ns;
    if (now_ns >= silence_end_ns) {
      Break(device_->Missing());
      continue;
    }
    const auto polled =
        device_->Poll(frame, std::min(deadline_ns, silence_end_ns) - now_ns);
    if (!polled.ok()) {
      Break(polled.status().message());
      continue;
    }
    if (*polled && Finish(frame)) return ReadResult::kFrame;
  }
  return ReadResult::kNoFrame;
}

bool HardwareDriver::Finish(SkinFrame& frame) {
  const int64_t now_ns = clock_->NowNs();
  last_frame_ns_ = quiet_since_ns_ = now_ns;
  if (attempts_ > 0) ++reconnects_;
  attempts_ = 0;
  CheckStuck(frame);
  if (options_.pose_at) {
    const auto pose = options_.pose_at(frame.capture_time_ns);
    if (!pose) {
      ++without_pose_;
      if (without_pose_since_ns_ == 0) without_pose_since_ns_ = now_ns;
      return false;
    }
    without_pose_since_ns_ = 0;
    frame.pose = *pose;
  }
  // A stream needs rising times; stamps of two adapters may differ a little.
  frame.capture_time_ns = std::max(frame.capture_time_ns, last_capture_ns_ + 1);
  last_capture_ns_ = frame.capture_time_ns;
  frame.missing_before = meter_->Add(frame.capture_time_ns, now_ns);
  return true;
}

void HardwareDriver::CheckStuck(const SkinFrame& frame) {
  switch (info_.taxel_type) {
    case v1::TAXEL_TYPE_FLOAT32:
      values_ = frame.f32;
      break;
    case v1::TAXEL_TYPE_INT16:
      values_.assign(frame.i16.begin(), frame.i16.end());
      break;
    default:
      values_.assign(frame.u16.begin(), frame.u16.end());
  }
  stuck_->Add(loads_->Of(values_));
}

std::string HardwareDriver::PoseProblem() const {
  const std::string problem =
      options_.pose_problem ? options_.pose_problem() : "";
  return problem.empty() ? "the arm's pose is not known" : problem;
}

DriverStatistics HardwareDriver::Statistics() const {
  DriverStatistics statistics;
  if (meter_) meter_->Write(statistics);
  if (stuck_) statistics.stuck_taxels = stuck_->Taxels();
  statistics.incomplete = device_->incomplete();
  statistics.without_pose = without_pose_;
  // Single frames are only counted.
  if (without_pose_since_ns_ > 0 &&
      clock_->NowNs() - without_pose_since_ns_ >= options_.silence_ns) {
    statistics.pose_problem = PoseProblem();
  }
  statistics.reconnects = reconnects_;
  statistics.connected = connected_ && attempts_ == 0;
  statistics.problem = problem_;
  statistics.refused = device_->Refused();
  statistics.remarks = device_->Remarks();
  return statistics;
}

}  // namespace tactus::internal::client
