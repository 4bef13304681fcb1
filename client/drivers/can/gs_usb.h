// File: gs_usb.h
//
// GsUsb: a CAN bus behind a gs_usb adapter (candleLight, CANable and others),
// driven from this process with libusb: no kernel module, no root, only access
// to the USB device.
//
//   GsUsb bus({.bit_rate = 1'000'000});
//   TACTUS_RETURN_IF_ERROR(bus.Open({}));
//
// Frames carry the adapter's time stamps, if it has some, on the host's clock.
// About 30 transfers wait for frames at any time. They are taken up in Receive
// only, so it must be called every few milliseconds: use BufferedDriver. Open
// takes the adapter from the kernel's driver, and Close gives it back. Not
// thread-safe.
#pragma once

#include <memory>
#include <string>

#include "client/drivers/can/can_bus.h"
#include "client/drivers/clock.h"

namespace tactus::internal::client {

struct GsUsbOptions {
  uint32_t bit_rate = 1'000'000;
  // The adapter's serial number, if there are several; empty: the first one.
  std::string serial = {};
  int channel = 0;
  // Transfers that wait for frames, 1 to 256.
  int transfers = 30;
};

class GsUsb : public CanBus {
 public:
  // `clock` outlives the bus.
  explicit GsUsb(const GsUsbOptions& options, Clock* clock = &Clock::System());
  // Closes, which stops the adapter.
  ~GsUsb() override;

  GsUsb(const GsUsb&) = delete;
  GsUsb& operator=(const GsUsb&) = delete;

  std::string name() const override;
  absl::Status Open(std::span<const CanFilter> filters) override;
  void Close() override;
  absl::Status Send(const CanFrame& frame) override;
  absl::StatusOr<bool> Receive(CanFrame& frame, int64_t timeout_ns) override;
  CanCounters counters() const override;

 private:
  // The open adapter; hides libusb.
  class Device;

  const GsUsbOptions options_;
  Clock* const clock_;
  CanCounters counters_;
  std::unique_ptr<Device> device_;
};

}  // namespace tactus::internal::client
