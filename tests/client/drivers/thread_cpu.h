// File: thread_cpu.h
//
// ThreadCpu: another driver, and the processor time that its calls take, so
// that a test can state the cost of a driver apart from what plays its device
// in the same process. Test-only.
//
//   ThreadCpu measured(&driver);
//   BufferedDriver buffered(&measured, {});
//   measured.seconds();
//
// Not thread-safe, but for seconds().
#pragma once

#include <sys/resource.h>
#include <time.h>

#include <atomic>

#include "client/drivers/skin_driver.h"

namespace tactus::internal::client {

class ThreadCpu : public SkinDriver {
 public:
  explicit ThreadCpu(SkinDriver* driver) : driver_(driver) {}

  DriverStatistics Statistics() const override { return driver_->Statistics(); }

  // Time of all calls of Read so far, on whatever thread, and the part that the
  // kernel took.
  double seconds() const { return static_cast<double>(ns_) / 1e9; }
  double system_seconds() const {
    return static_cast<double>(system_ns_) / 1e9;
  }

 protected:
  absl::StatusOr<SkinInfo> OnConfigure() override {
    return driver_->Configure();
  }
  absl::Status OnActivate() override { return driver_->Activate(); }
  absl::Status OnDeactivate() override { return driver_->Deactivate(); }
  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override {
    const int64_t before = NowNs();
    const int64_t system_before = SystemNs();
    auto result = driver_->Read(frame);
    ns_ += NowNs() - before;
    system_ns_ += SystemNs() - system_before;
    return result;
  }
  absl::Status OnFinalise() override { return driver_->Finalise(); }

 private:
  static int64_t NowNs() {
    timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return time.tv_sec * 1'000'000'000 + time.tv_nsec;
  }

  static int64_t SystemNs() {
    rusage usage;
    getrusage(RUSAGE_THREAD, &usage);
    return usage.ru_stime.tv_sec * 1'000'000'000 +
           usage.ru_stime.tv_usec * 1'000;
  }

  SkinDriver* const driver_;
  std::atomic<int64_t> ns_ = 0;
  std::atomic<int64_t> system_ns_ = 0;
};

}  // namespace tactus::internal::client
