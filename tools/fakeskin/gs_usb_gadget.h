// File: gs_usb_gadget.h
//
// GsUsbGadget: the CAN bus behind a gs_usb adapter (1d50:606f) that this
// process plays for a USB host, through FunctionFS. What is sent on this bus,
// the host gets from its adapter, and the reverse.
//
//   GsUsbGadget bus({.directory = "/dev/skin", .gadget = gadget});
//   TACTUS_RETURN_IF_ERROR(PlayPeer(boards, bus, Clock::System(), go_on));
//
// While the host has not started the adapter, or has stopped it, frames are
// lost, as on a real bus. Those of the host are counted in `while_stopped`.
// Frames that the host does not fetch are lost and counted in `overruns`.
// Receive has to be called all the time: it answers the host. Not thread-safe.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "client/drivers/can/can_bus.h"
#include "client/drivers/clock.h"
#include "tools/fakeskin/function_fs.h"
#include "tools/fakeskin/gs_usb_firmware.h"

namespace tactus::internal::client {

class GsUsbGadget : public CanBus {
 public:
  // `clock` outlives the bus.
  explicit GsUsbGadget(const FunctionFsOptions& options,
                       Clock* clock = &Clock::System());

  std::string name() const override { return name_; }
  absl::Status Open(std::span<const CanFilter> filters) override;
  void Close() override { function_.Close(); }
  // The frame's time is the one that the host gets as the adapter's stamp.
  absl::Status Send(const CanFrame& frame) override;
  absl::StatusOr<bool> Receive(CanFrame& frame, int64_t timeout_ns) override;
  CanCounters counters() const override { return counters_; }
  uint64_t while_stopped() const { return while_stopped_; }

 private:
  void OnReceived(std::span<const uint8_t> bytes);

  const std::string name_;
  Clock* const clock_;
  GsUsbFirmware firmware_;
  FunctionFs function_;
  std::vector<CanFilter> filters_;
  std::deque<CanFrame> received_;
  CanCounters counters_;
  uint64_t while_stopped_ = 0;
};

}  // namespace tactus::internal::client
