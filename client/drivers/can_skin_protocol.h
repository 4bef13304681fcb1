// File: can_skin_protocol.h
//
// CanSkinProtocol: what a kind of skin says on a CAN bus. CanSkinDriver runs
// it; it does no I/O but through the bus that it is given.
//
//   TACTUS_RETURN_IF_ERROR(bus.Open(protocol.Filters()));
//   TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, protocol.Setup(bus, clock));
//   TACTUS_RETURN_IF_ERROR(protocol.Start(bus));
//   if (protocol.Take(can_frame, skin_frame)) Use(skin_frame);
//
// Not thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/drivers/can/can_bus.h"
#include "client/drivers/clock.h"
#include "client/stream/skin_frame.h"

namespace tactus::internal::client {

class CanSkinProtocol {
 public:
  virtual ~CanSkinProtocol() = default;

  // The frames that Setup and Take want.
  virtual std::vector<CanFilter> Filters() const = 0;
  // Finds and configures the skin and leaves it silent. Takes up to a few
  // seconds of `clock`. IO naming what does not answer.
  virtual absl::StatusOr<SkinInfo> Setup(CanBus& bus, Clock& clock) = 0;
  // The skin begins to send, or ends it. Start forgets parts of frames.
  virtual absl::Status Start(CanBus& bus) = 0;
  virtual absl::Status Stop(CanBus& bus) = 0;
  // True if `can` completed a skin frame, which overwrites `frame` except for
  // its pose and missing_before. Any other frame is counted or ignored.
  virtual bool Take(const CanFrame& can, SkinFrame& frame) = 0;
  // From one frame of the skin to the next, as configured.
  virtual int64_t period_ns() const = 0;
  // What was lost so far of frames that were begun.
  virtual uint64_t incomplete() const = 0;
  // Words on what Setup found that a user should know; empty if nothing.
  virtual std::string Remarks() const = 0;
  // Words on what keeps the next frame from being complete, e.g. "board 12
  // sends nothing".
  virtual std::string Missing() const = 0;
};

}  // namespace tactus::internal::client
