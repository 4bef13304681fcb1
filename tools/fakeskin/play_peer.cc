#include "tools/fakeskin/play_peer.h"

#include <algorithm>

#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

constexpr int64_t kLongestWaitNs = 100'000'000;

}  // namespace

absl::Status PlayPeer(CanPeer& peer, CanBus& bus, Clock& clock,
                      const std::function<bool()>& go_on) {
  TACTUS_RETURN_IF_ERROR(bus.Open({}));
  while (go_on()) {
    for (CanFrame frame; peer.Emit(clock.NowNs(), frame);) {
      TACTUS_RETURN_IF_ERROR(bus.Send(frame));
    }
    const int64_t now_ns = clock.NowNs();
    const int64_t next_ns = peer.NextNs();
    const int64_t wait_ns =
        next_ns == CanPeer::kNever
            ? kLongestWaitNs
            : std::clamp<int64_t>(next_ns - now_ns, 0, kLongestWaitNs);
    CanFrame frame;
    TACTUS_ASSIGN_OR_RETURN(const bool received, bus.Receive(frame, wait_ns));
    if (received) peer.OnFrame(frame, clock.NowNs());
  }
  bus.Close();
  return absl::OkStatus();
}

}  // namespace tactus::internal::client
