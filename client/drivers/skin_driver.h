// File: skin_driver.h
//
// SkinDriver: where skin frames come from, be it hardware, a simulation or a
// recording. A driver has four states, like ros2_control's hardware
// components:
//
//   UNCONFIGURED --Configure--> INACTIVE --Activate--> ACTIVE
//                               INACTIVE <-Deactivate- ACTIVE
//   each of them --Finalise--> FINALISED
//
//   TACTUS_ASSIGN_OR_RETURN(SkinInfo info, driver.Configure());
//   TACTUS_RETURN_IF_ERROR(driver.Activate());
//   SkinFrame frame;
//   while (true) {
//     TACTUS_ASSIGN_OR_RETURN(ReadResult result, driver.Read(frame));
//     if (result == ReadResult::kEndOfData) break;
//     if (result == ReadResult::kFrame) Use(frame);
//   }
//   TACTUS_RETURN_IF_ERROR(driver.Finalise());
//
// A call in the wrong state fails and changes nothing. So does a call in which
// the driver itself fails. docs/drivers.md describes the failures of hardware.
// Not thread-safe: each driver belongs to one thread.
#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/drivers/driver_statistics.h"
#include "client/stream/skin_frame.h"
#include "tactus/driver.h"

namespace tactus::internal::client {

enum class DriverState { kUnconfigured, kInactive, kActive, kFinalised };

class SkinDriver {
 public:
  virtual ~SkinDriver() = default;

  // What all frames of this driver are like.
  absl::StatusOr<SkinInfo> Configure();
  absl::Status Activate();
  absl::Status Deactivate();
  // Overwrites `frame`, whose memory is used again.
  absl::StatusOr<ReadResult> Read(SkinFrame& frame);
  // Gives up the hardware, whatever the state; OK if that was done before.
  absl::Status Finalise();

  // How well frames come. Zeros for drivers without hardware.
  virtual DriverStatistics Statistics() const { return {}; }

  DriverState state() const { return state_; }

 protected:
  virtual absl::StatusOr<SkinInfo> OnConfigure() = 0;
  virtual absl::Status OnActivate() { return absl::OkStatus(); }
  virtual absl::Status OnDeactivate() { return absl::OkStatus(); }
  virtual absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) = 0;
  // Called once, never in the active state.
  virtual absl::Status OnFinalise() { return absl::OkStatus(); }

 private:
  absl::Status Expect(DriverState state) const;

  DriverState state_ = DriverState::kUnconfigured;
};

}  // namespace tactus::internal::client
