// File: skin_device.h
//
// SkinDevice: one skin and how it is connected, as HardwareDriver runs it.
//
//   TACTUS_RETURN_IF_ERROR(device.Open());
//   TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, device.Setup(clock));
//   TACTUS_RETURN_IF_ERROR(device.Start());
//   TACTUS_ASSIGN_OR_RETURN(const bool whole,
//                           device.Poll(frame, /*timeout_ns=*/100'000'000));
//
// Errors have the reason IO and name the device. Not thread-safe.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/drivers/clock.h"
#include "client/stream/skin_frame.h"

namespace tactus::internal::client {

class SkinDevice {
 public:
  virtual ~SkinDevice() = default;

  // As the user named it: "can0", "/dev/ttyUSB0".
  virtual std::string name() const = 0;
  virtual absl::Status Open() = 0;
  // Without effect on a closed device.
  virtual void Close() = 0;
  // Finds and configures the skin and leaves it silent. Takes up to a few
  // seconds of `clock`.
  virtual absl::StatusOr<SkinInfo> Setup(Clock& clock) = 0;
  // The skin begins to send, or ends it. Start forgets parts of frames.
  virtual absl::Status Start() = 0;
  virtual absl::Status Stop() = 0;
  // True if a whole frame came, which overwrites `frame` except for its pose
  // and missing_before. False after `timeout_ns`, or earlier if something else
  // came. An error means that the device must be closed and opened again.
  virtual absl::StatusOr<bool> Poll(SkinFrame& frame, int64_t timeout_ns) = 0;
  // From one frame to the next.
  virtual int64_t period_ns() const = 0;
  // Frames that were begun and lost.
  virtual uint64_t incomplete() const = 0;
  // What Setup found that a user should know; empty if nothing.
  virtual std::string Remarks() const = 0;
  // What keeps the next frame from being complete.
  virtual std::string Missing() const = 0;
  // Why frames that came whole were refused; empty if none were.
  virtual std::string Refused() const { return ""; }
};

}  // namespace tactus::internal::client
