// File: gs_usb_firmware.h
//
// GsUsbFirmware: a gs_usb adapter, simulated without its USB wire: answers
// control requests, and turns the frames of the host into CAN frames and back.
// The caller has the USB endpoints and the bus.
//
//   GsUsbFirmware firmware({}, clock.NowNs());
//   if (!firmware.Write(setup.bRequest, data)) Stall();
//   if (const auto sent = firmware.TakeSent(bytes)) {
//     bus.Send(sent->frame);
//     Submit(sent->echo);
//   }
//   Submit(firmware.FromBus(frame));
//
// Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "client/drivers/can/gs_usb_protocol.h"

namespace tactus::internal::client {

struct GsUsbFirmwareOptions {
  uint32_t features = gs_usb::kHardwareStamps;
  uint32_t clock_hz = 48'000'000;
  // Value of the first time stamp.
  uint32_t first_stamp_us = 0;
  // Echoes have the overflow flag and no stamp, as old firmware sends them.
  bool old_echoes = false;
};

class GsUsbFirmware {
 public:
  // A padded frame has the size of a full-speed packet of this adapter.
  static constexpr size_t kPacketBytes = 32;

  // `begin_ns` is the time of the first time stamp.
  GsUsbFirmware(const GsUsbFirmwareOptions& options, int64_t begin_ns);

  // A vendor request with data from the host. False: the adapter stalls.
  bool Write(uint8_t request, std::span<const uint8_t> bytes);
  // A vendor request for data. Nothing: the adapter stalls.
  std::optional<std::vector<uint8_t>> Read(uint8_t request,
                                           int64_t now_ns) const;

  struct Sent {
    CanFrame frame;
    // What the host gets when the frame was on the bus.
    std::vector<uint8_t> echo;
  };
  // A bulk transfer of the host. Nothing if it is no frame, or the adapter is
  // not started.
  std::optional<Sent> TakeSent(std::span<const uint8_t> bytes,
                               int64_t now_ns) const;
  // The bulk transfer for a frame that the bus carried at `frame.time_ns`.
  std::vector<uint8_t> FromBus(const CanFrame& frame) const;

  // As after power-on; the bit timing stays.
  void Reset() { started_ = false; }

  // What the host has set up.
  bool started() const { return started_; }
  uint32_t mode_flags() const { return flags_; }
  const std::vector<uint8_t>& bit_timing() const { return bit_timing_; }

 private:
  uint32_t StampUs(int64_t time_ns) const;

  const GsUsbFirmwareOptions options_;
  const int64_t begin_ns_;
  bool started_ = false;
  uint32_t flags_ = 0;
  std::vector<uint8_t> bit_timing_;
};

}  // namespace tactus::internal::client
