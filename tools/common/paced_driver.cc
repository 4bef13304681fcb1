#include "tools/common/paced_driver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

constexpr int64_t kReadTimeoutNs = 100'000'000;

}  // namespace

absl::StatusOr<SkinInfo> PacedDriver::OnConfigure() {
  TACTUS_ASSIGN_OR_RETURN(SkinInfo info, driver_->Configure());
  meter_.emplace(std::llround(1e9 / info.sample_rate_hz));
  return info;
}

absl::Status PacedDriver::OnActivate() {
  waiting_ = false;
  start_ns_.reset();
  meter_->Pause();
  return driver_->Activate();
}

absl::StatusOr<ReadResult> PacedDriver::OnRead(SkinFrame& frame) {
  if (!waiting_) {
    TACTUS_ASSIGN_OR_RETURN(const ReadResult result, driver_->Read(next_));
    if (result == ReadResult::kEndOfTrial) meter_->Pause();
    if (result != ReadResult::kFrame) return result;
    waiting_ = true;
    if (!start_ns_) start_ns_ = clock_->NowNs() - next_.capture_time_ns;
  }
  const int64_t due_ns = *start_ns_ + next_.capture_time_ns;
  const int64_t wait_ns = due_ns - clock_->NowNs();
  if (wait_ns > 0) clock_->SleepNs(std::min(wait_ns, kReadTimeoutNs));
  if (wait_ns > kReadTimeoutNs) return ReadResult::kNoFrame;
  waiting_ = false;
  std::swap(frame, next_);
  frame.capture_time_ns = due_ns;
  meter_->Add(due_ns, clock_->NowNs());
  return ReadResult::kFrame;
}

DriverStatistics PacedDriver::Statistics() const {
  DriverStatistics statistics;
  if (meter_) meter_->Write(statistics);
  statistics.connected = true;
  return statistics;
}

}  // namespace tactus::internal::client
