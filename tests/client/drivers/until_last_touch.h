// File: until_last_touch.h
//
// A driver that ends its data when all simulated contacts are over. Test-only.
//
//   UntilLastTouch driver(&boards_driver, &touches, &clock);
//
// Does not own what it is given. Not thread-safe.
#pragma once

#include <cstdint>
#include <optional>

#include "absl/status/statusor.h"
#include "client/drivers/clock.h"
#include "client/drivers/skin_driver.h"
#include "tools/fakeskin/sim_touches.h"

namespace tactus::internal::client {

class UntilLastTouch : public SkinDriver {
 public:
  UntilLastTouch(SkinDriver* driver, const SimTouches* touches, Clock* clock)
      : driver_(driver), touches_(touches), clock_(clock) {}
  DriverStatistics Statistics() const override { return driver_->Statistics(); }

 protected:
  absl::StatusOr<SkinInfo> OnConfigure() override {
    return driver_->Configure();
  }
  absl::Status OnActivate() override { return driver_->Activate(); }
  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override {
    const std::optional<int64_t> end_ns = touches_->end_ns();
    if (end_ns && clock_->NowNs() > *end_ns) return ReadResult::kEndOfData;
    return driver_->Read(frame);
  }
  absl::Status OnFinalise() override { return driver_->Finalise(); }

 private:
  SkinDriver* const driver_;
  const SimTouches* const touches_;
  Clock* const clock_;
};

}  // namespace tactus::internal::client
