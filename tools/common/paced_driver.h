// File: paced_driver.h
//
// PacedDriver: plays another driver's frames at the times at which a skin would
// have sent them, so that simulated and recorded contacts can stand for a real
// skin.
//
//   SimDriver sim({.seed = 7}, /*trials=*/4, {});
//   PacedDriver driver(&sim);
//
// A frame's capture time is the one on `clock` at which it is due. The time
// between two trials passes without frames. Read waits at most 0.1 s. The other
// driver and the clock outlive this one. Not thread-safe.
#pragma once

#include <cstdint>
#include <optional>

#include "client/drivers/clock.h"
#include "client/drivers/skin_driver.h"

namespace tactus::internal::client {

class PacedDriver : public SkinDriver {
 public:
  explicit PacedDriver(SkinDriver* driver, Clock* clock = &Clock::System())
      : driver_(driver), clock_(clock) {}
  ~PacedDriver() override { Finalise().IgnoreError(); }

  // Frames, rate, jitter and age.
  DriverStatistics Statistics() const override;

 protected:
  absl::StatusOr<SkinInfo> OnConfigure() override;
  absl::Status OnActivate() override;
  absl::Status OnDeactivate() override { return driver_->Deactivate(); }
  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override;
  absl::Status OnFinalise() override { return driver_->Finalise(); }

 private:
  SkinDriver* const driver_;
  Clock* const clock_;
  std::optional<FrameMeter> meter_;
  // The next frame was read from the other driver and is not due yet.
  bool waiting_ = false;
  SkinFrame next_;
  // The time on `clock_` of capture time 0.
  std::optional<int64_t> start_ns_;
};

}  // namespace tactus::internal::client
