// File: play_peer.h
//
// Plays a simulated CAN node on a real bus.
//
//   TACTUS_RETURN_IF_ERROR(
//       PlayPeer(boards, bus, Clock::System(), [&] { return !interrupted; }));
//
// Belongs to one thread.
#pragma once

#include <functional>

#include "absl/status/status.h"
#include "client/drivers/can/can_bus.h"
#include "client/drivers/clock.h"
#include "tools/fakeskin/can_peer.h"

namespace tactus::internal::client {

// Opens the bus and plays until `go_on`, which is asked at least every 0.1 s,
// returns false. IO if the bus fails.
absl::Status PlayPeer(CanPeer& peer, CanBus& bus, Clock& clock,
                      const std::function<bool()>& go_on);

}  // namespace tactus::internal::client
