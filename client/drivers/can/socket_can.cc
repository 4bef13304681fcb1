#include "client/drivers/can/socket_can.h"

#include <linux/can.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/drivers/can/can_error.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

static_assert(sizeof(can_frame) == 16, "as CanSockets::Message holds it");

constexpr int kSendTries = 20;
constexpr int64_t kSendPauseNs = 1'000'000;

const char* Advice(int error) {
  switch (error) {
    case EAFNOSUPPORT:
      return ": this kernel has no CAN (modules can and can-raw)";
    case ENODEV:
      return ": there is no such interface (ip link)";
    case ENETDOWN:
      return ": the interface is down (ip link set ... up)";
    case ENOBUFS:
      return ": nobody on the bus takes frames, or its queue is too short";
    default:
      return "";
  }
}

}  // namespace

SocketCan::SocketCan(std::string interface, CanSockets* sockets, Clock* clock)
    : interface_(std::move(interface)), sockets_(sockets), clock_(clock) {}

SocketCan::~SocketCan() { Close(); }

absl::Status SocketCan::Failed(const char* what, int error) const {
  return IoError(interface_, absl::StrCat(what, ": ", std::strerror(-error),
                                          Advice(-error)));
}

absl::Status SocketCan::Open(std::span<const CanFilter> filters) {
  Close();
  if (was_bus_off_) {
    // Without the right to do it, the kernel's restart-ms has to.
    const int restarted = sockets_->Restart(interface_);
    if (restarted < 0 && restarted != -EPERM && restarted != -EOPNOTSUPP &&
        restarted != -EBUSY && restarted != -EINVAL) {
      return Failed("restart after bus-off", restarted);
    }
    was_bus_off_ = false;
  }
  const int socket = sockets_->Open(interface_, filters);
  if (socket < 0) return Failed("open", socket);
  socket_ = socket;
  dropped_ = 0;
  return absl::OkStatus();
}

void SocketCan::Close() {
  if (socket_ >= 0) sockets_->Close(socket_);
  socket_ = -1;
}

absl::Status SocketCan::Send(const CanFrame& frame) {
  if (socket_ < 0) return IoError(interface_, "is closed");
  can_frame raw = {};
  raw.can_id = frame.id;
  if (frame.extended) raw.can_id |= CAN_EFF_FLAG;
  if (frame.remote) raw.can_id |= CAN_RTR_FLAG;
  raw.can_dlc = std::min<uint8_t>(frame.size, CAN_MAX_DLEN);
  std::copy_n(frame.data.begin(), raw.can_dlc, raw.data);
  const std::span<const uint8_t> bytes(reinterpret_cast<const uint8_t*>(&raw),
                                       sizeof(raw));
  int error = sockets_->Write(socket_, bytes);
  for (int i = 1; i < kSendTries && (error == -ENOBUFS || error == -EAGAIN);
       ++i) {
    clock_->SleepNs(kSendPauseNs);
    error = sockets_->Write(socket_, bytes);
  }
  if (error < 0) return Failed("send", error);
  ++counters_.sent;
  return absl::OkStatus();
}

absl::StatusOr<bool> SocketCan::Receive(CanFrame& frame, int64_t timeout_ns) {
  if (socket_ < 0) return IoError(interface_, "is closed");
  const int64_t end_ns = clock_->NowNs() + timeout_ns;
  while (true) {
    CanSockets::Message message;
    message.dropped = dropped_;
    const int read = sockets_->Read(socket_, message);
    if (read < 0) return Failed("receive", read);
    if (read > 0) {
      TACTUS_ASSIGN_OR_RETURN(const bool is_data, Use(message, frame));
      if (is_data) return true;
      continue;
    }
    const int64_t left_ns = end_ns - clock_->NowNs();
    if (left_ns <= 0) return false;
    const int ready = sockets_->Wait(socket_, left_ns);
    if (ready < 0) return Failed("wait", ready);
  }
}

absl::StatusOr<bool> SocketCan::Use(const CanSockets::Message& message,
                                    CanFrame& frame) {
  if (message.dropped != dropped_) ++counters_.overruns;
  dropped_ = message.dropped;
  can_frame raw;
  if (message.size != sizeof(raw)) {
    ++counters_.malformed;
    return false;
  }
  std::memcpy(&raw, message.bytes.data(), sizeof(raw));
  if (raw.can_dlc > CAN_MAX_DLEN) {
    ++counters_.malformed;
    return false;
  }
  if ((raw.can_id & kCanErrorBit) != 0) {
    ++counters_.error_frames;
    const CanError error =
        ReadCanError(raw.can_id, {raw.data, size_t{raw.can_dlc}});
    counters_.overruns += error.overflow;
    if (!error.bus_off) return false;
    ++counters_.bus_offs;
    was_bus_off_ = true;
    return IoError(interface_,
                   "bus-off: the controller gave up after too many errors on "
                   "the wire (bit rate, termination, cable)");
  }
  frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
  frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.size = raw.can_dlc;
  std::copy_n(raw.data, 8, frame.data.begin());
  const int64_t now_ns = clock_->NowNs();
  frame.time_ns = now_ns;
  if (message.realtime_ns != 0) {
    // The kernel stamps with another clock, which may be set at any time.
    const int64_t age_ns = sockets_->RealtimeNs() - message.realtime_ns;
    if (age_ns >= 0 && age_ns < 10'000'000'000) frame.time_ns -= age_ns;
  }
  frame.time_ns = std::max(frame.time_ns, last_time_ns_);
  last_time_ns_ = frame.time_ns;
  ++counters_.received;
  return !frame.remote;
}

}  // namespace tactus::internal::client
