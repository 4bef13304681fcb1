#include "client/drivers/buffered_driver.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

constexpr std::chrono::milliseconds kStatisticsInterval{250};

}  // namespace

BufferedDriver::BufferedDriver(SkinDriver* driver,
                               const BufferedDriverOptions& options)
    : driver_(driver),
      options_(options),
      ring_(std::max<size_t>(options.frames, 1)) {}

BufferedDriver::~BufferedDriver() { Finalise().IgnoreError(); }

absl::StatusOr<SkinInfo> BufferedDriver::OnConfigure() {
  auto info = driver_->Configure();
  const std::lock_guard lock(mutex_);
  statistics_ = driver_->Statistics();
  return info;
}

absl::Status BufferedDriver::OnActivate() {
  TACTUS_RETURN_IF_ERROR(driver_->Activate());
  first_ = count_ = 0;
  ended_ = false;
  stop_ = false;
  thread_ = std::thread([this] { ReadAll(); });
  return absl::OkStatus();
}

absl::Status BufferedDriver::OnDeactivate() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  return driver_->Deactivate();
}

absl::Status BufferedDriver::OnFinalise() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  return driver_->Finalise();
}

void BufferedDriver::ReadAll() {
  using Clock = std::chrono::steady_clock;
  SkinFrame frame;
  Clock::time_point next_statistics = Clock::now();
  while (!stop_) {
    const auto result = driver_->Read(frame);
    const bool at_end = !result.ok() || *result == ReadResult::kEndOfData;
    const bool quiet = at_end || *result == ReadResult::kNoFrame;
    const std::lock_guard lock(mutex_);
    if (quiet || Clock::now() >= next_statistics) {
      statistics_ = driver_->Statistics();
      next_statistics = Clock::now() + kStatisticsInterval;
    }
    if (at_end) {
      ended_ = true;
      end_status_ = result.status();
      changed_.notify_one();
      return;
    }
    if (!quiet) Push(frame, *result);
  }
}

void BufferedDriver::Push(SkinFrame& frame, ReadResult result) {
  if (count_ == ring_.size()) {
    const Entry& oldest = ring_[first_];
    const uint64_t lost = oldest.result == ReadResult::kFrame
                              ? oldest.frame.missing_before + 1
                              : 0;
    overwritten_ += oldest.result == ReadResult::kFrame;
    first_ = (first_ + 1) % ring_.size();
    --count_;
    // The one that is oldest now; with a ring of one, that is the new one.
    SkinFrame& next = count_ > 0 ? ring_[first_].frame : frame;
    next.missing_before += lost;
  }
  Entry& entry = ring_[(first_ + count_) % ring_.size()];
  entry.result = result;
  std::swap(entry.frame, frame);
  ++count_;
  changed_.notify_one();
}

absl::StatusOr<ReadResult> BufferedDriver::OnRead(SkinFrame& frame) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::nanoseconds(options_.read_timeout_ns),
                    [this] { return count_ > 0 || ended_; });
  if (count_ > 0) {
    Entry& entry = ring_[first_];
    std::swap(entry.frame, frame);
    first_ = (first_ + 1) % ring_.size();
    --count_;
    return entry.result;
  }
  if (!ended_) return ReadResult::kNoFrame;
  if (!end_status_.ok()) return end_status_;
  return ReadResult::kEndOfData;
}

DriverStatistics BufferedDriver::Statistics() const {
  const std::lock_guard lock(mutex_);
  DriverStatistics statistics = statistics_;
  statistics.overwritten = overwritten_;
  return statistics;
}

}  // namespace tactus::internal::client
