// File: can_bus.h
//
// CanBus: one CAN bus as a skin's driver uses it, whatever the adapter.
//
//   const CanFilter skins[] = {{.id = 0x400, .mask = 0x700}};
//   TACTUS_RETURN_IF_ERROR(bus.Open(skins));
//   TACTUS_RETURN_IF_ERROR(bus.Send(MakeCanFrame(0x201, {0x07, 0x00})));
//   CanFrame frame;
//   TACTUS_ASSIGN_OR_RETURN(const bool received,
//                           bus.Receive(frame, /*timeout_ns=*/100'000'000));
//
// An error of Receive means that the bus cannot be used any more: the adapter
// is gone, the interface is down, or the controller is bus-off. Close and Open
// begin anew; Open also restarts a controller that is bus-off. Errors have the
// reason IO and name the bus. Not thread-safe: one thread a bus.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/drivers/can/can_frame.h"

namespace tactus::internal::client {

// Counted since the object was made; Open does not reset them.
struct CanCounters {
  uint64_t received = 0;
  uint64_t sent = 0;
  // Messages of the controller about errors on the wire.
  uint64_t error_frames = 0;
  // Times at which adapter or kernel reported that it had lost frames.
  uint64_t overruns = 0;
  uint64_t bus_offs = 0;
  // Messages of the adapter that were no frames.
  uint64_t malformed = 0;
};

class CanBus {
 public:
  virtual ~CanBus() = default;

  // As the user named it, for messages: "can0", "usb 1d50:606f".
  virtual std::string name() const = 0;
  // Receives what passes one of `filters`; without filters, everything.
  virtual absl::Status Open(std::span<const CanFilter> filters) = 0;
  // Without effect on a closed bus.
  virtual void Close() = 0;
  // Waits a few hundredths of a second for room in the queue, then IO.
  virtual absl::Status Send(const CanFrame& frame) = 0;
  // True if a data frame was received; false if none came in time.
  virtual absl::StatusOr<bool> Receive(CanFrame& frame, int64_t timeout_ns) = 0;
  virtual CanCounters counters() const = 0;
};

}  // namespace tactus::internal::client
