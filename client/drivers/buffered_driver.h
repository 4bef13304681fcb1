// File: buffered_driver.h
//
// BufferedDriver: reads another driver in a separate thread, so that a slow
// stream does not hold up the hardware, nor the hardware a stream.
//
//   BufferedDriver driver(&can_skin_driver, {.frames = 64});
//   TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, driver.Configure());
//
// If nobody reads for longer than the buffer lasts, the oldest frames are
// overwritten; the next frame's missing_before counts them. An error of the
// other driver is returned once all frames before it are read, and from then
// on. The other driver outlives this one and must not be used beside it; it is
// configured, finalised and so on with this one.
//
// Not thread-safe, but for Statistics.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <thread>
#include <vector>

#include "client/drivers/skin_driver.h"

namespace tactus::internal::client {

struct BufferedDriverOptions {
  // At least 1.
  size_t frames = 64;
  // Read waits this long for a frame.
  int64_t read_timeout_ns = 100'000'000;
};

class BufferedDriver : public SkinDriver {
 public:
  BufferedDriver(SkinDriver* driver, const BufferedDriverOptions& options);
  ~BufferedDriver() override;

  // At most a quarter of a second old.
  DriverStatistics Statistics() const override;

 protected:
  absl::StatusOr<SkinInfo> OnConfigure() override;
  absl::Status OnActivate() override;
  absl::Status OnDeactivate() override;
  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override;
  absl::Status OnFinalise() override;

 private:
  void ReadAll();
  void Push(SkinFrame& frame, ReadResult result);

  SkinDriver* const driver_;
  const BufferedDriverOptions options_;
  std::thread thread_;
  std::atomic<bool> stop_ = false;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // A ring: `count_` entries from `first_` on.
  struct Entry {
    ReadResult result = ReadResult::kFrame;
    SkinFrame frame;
  };
  std::vector<Entry> ring_;
  size_t first_ = 0;
  size_t count_ = 0;
  uint64_t overwritten_ = 0;
  // The reading thread has ended: with this.
  bool ended_ = false;
  absl::Status end_status_;
  DriverStatistics statistics_;
};

}  // namespace tactus::internal::client
