// File: socket_can.h
//
// SocketCan: a CAN bus of the Linux kernel, "can0" or "vcan0", whatever the
// adapter. The interface must be up, with its bit rate:
//
//   ip link set can0 up type can bitrate 1000000 restart-ms 100
//
//   SocketCan bus("can0");
//   TACTUS_RETURN_IF_ERROR(bus.Open({}));
//
// Frames carry the kernel's time of receipt. Filters run in the kernel. Open
// restarts a controller that is bus-off, if the program may (CAP_NET_ADMIN);
// with restart-ms the kernel does it. Not thread-safe.
#pragma once

#include <string>
#include <vector>

#include "client/drivers/can/can_bus.h"
#include "client/drivers/can/can_sockets.h"
#include "client/drivers/clock.h"

namespace tactus::internal::client {

class SocketCan : public CanBus {
 public:
  // `sockets` and `clock` outlive the bus; tests replace them.
  explicit SocketCan(std::string interface,
                     CanSockets* sockets = &CanSockets::System(),
                     Clock* clock = &Clock::System());
  ~SocketCan() override;

  SocketCan(const SocketCan&) = delete;
  SocketCan& operator=(const SocketCan&) = delete;

  std::string name() const override { return interface_; }
  absl::Status Open(std::span<const CanFilter> filters) override;
  void Close() override;
  absl::Status Send(const CanFrame& frame) override;
  absl::StatusOr<bool> Receive(CanFrame& frame, int64_t timeout_ns) override;
  CanCounters counters() const override { return counters_; }

 private:
  absl::Status Failed(const char* what, int error) const;
  // True if the message is a data frame, which is written to `frame`.
  absl::StatusOr<bool> Use(const CanSockets::Message& message, CanFrame& frame);

  const std::string interface_;
  CanSockets* const sockets_;
  Clock* const clock_;
  int socket_ = -1;
  bool was_bus_off_ = false;
  // The kernel's count of dropped frames, of this socket.
  uint32_t dropped_ = 0;
  int64_t last_time_ns_ = 0;
  CanCounters counters_;
};

}  // namespace tactus::internal::client
