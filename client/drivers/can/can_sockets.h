// File: can_sockets.h
//
// CanSockets: the calls to the kernel that SocketCan makes, so that tests can
// play the kernel. Each returns a negative errno on failure.
//
//   CanSockets& sockets = CanSockets::System();
//   const int socket = sockets.Open("can0", filters);
//   if (socket < 0) Report(-socket);
//
// System() is thread-safe, a socket is not.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "client/drivers/can/can_frame.h"

namespace tactus::internal::client {

class CanSockets {
 public:
  // What one read from a socket gives.
  struct Message {
    // A struct can_frame.
    std::array<uint8_t, 16> bytes = {};
    size_t size = 0;
    // Time of receipt, CLOCK_REALTIME; 0 if the kernel gave none.
    int64_t realtime_ns = 0;
    // Frames that the kernel has dropped on this socket so far.
    uint32_t dropped = 0;
  };

  virtual ~CanSockets() = default;

  // A non-blocking raw CAN socket with time stamps and error frames.
  virtual int Open(const std::string& interface,
                   std::span<const CanFilter> filters) = 0;
  virtual void Close(int socket) = 0;
  // 1 if there is something to read, 0 if not in time.
  virtual int Wait(int socket, int64_t timeout_ns) = 0;
  // 1 if a message was read, 0 if there is none.
  virtual int Read(int socket, Message& message) = 0;
  // `bytes` is a struct can_frame. -ENOBUFS if the queue is full.
  virtual int Write(int socket, std::span<const uint8_t> bytes) = 0;
  // Restarts a controller that is bus-off.
  virtual int Restart(const std::string& interface) = 0;
  // CLOCK_REALTIME.
  virtual int64_t RealtimeNs() = 0;

  static CanSockets& System();
};

}  // namespace tactus::internal::client
