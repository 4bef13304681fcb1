// File: can_peer.h
//
// CanPeer: the other side of a CAN bus, simulated: takes the host's frames and
// sends frames at times that it chooses. The caller has the clock and the bus.
//
//   for (CanFrame frame; peer.Emit(clock.NowNs(), frame);) bus.Send(frame);
//   clock.SleepNs(peer.NextNs() - clock.NowNs());
//
// Not thread-safe.
#pragma once

#include <cstdint>
#include <limits>

#include "client/drivers/can/can_frame.h"

namespace tactus::internal::client {

class CanPeer {
 public:
  static constexpr int64_t kNever = std::numeric_limits<int64_t>::max();

  virtual ~CanPeer() = default;

  virtual void OnFrame(const CanFrame& frame, int64_t now_ns) = 0;
  // When Emit has something to send next; kNever if nothing is planned.
  virtual int64_t NextNs() = 0;
  // True if a frame is due at `now_ns`; its time is when it was due.
  virtual bool Emit(int64_t now_ns, CanFrame& frame) = 0;
};

}  // namespace tactus::internal::client
