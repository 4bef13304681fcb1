#include "server/listen/acceptor.h"

#include <poll.h>
#include <sys/eventfd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "core/base/limits_http2.h"
#include "server/ops/clock.h"
#include "server/ops/peer.h"
#include "spdlog/spdlog.h"

namespace tactus::internal::server {
namespace {

// Connections of one socket before the others have their turn.
constexpr int kAcceptsPerTurn = 64;
// How long to wait when descriptors or memory are short.
constexpr int kShortageWaitMs = 50;

}  // namespace

Acceptor::Acceptor(std::vector<ListeningSocket> sockets,
                   const ConnectionTable::Limits& limits,
                   OnConnection on_connection)
    : sockets_(std::move(sockets)),
      table_(limits),
      on_connection_(std::move(on_connection)),
      stop_event_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

void Acceptor::Start() {
  thread_ = std::thread([this] { Run(); });
}

void Acceptor::Stop() {
  if (thread_.joinable()) {
    eventfd_write(stop_event_.get(), 1);
    thread_.join();
  }
  sockets_.clear();
}

void Acceptor::ExpectSelfCheck(const SocketAddress& own) {
  const std::lock_guard lock(mutex_);
  self_check_ = own;
}

void Acceptor::Run() {
  std::vector<pollfd> polled;
  for (const ListeningSocket& socket : sockets_) {
    polled.push_back({socket.fd.get(), POLLIN, 0});
  }
  polled.push_back({stop_event_.get(), POLLIN, 0});
  while (true) {
    const int events =
        poll(polled.data(), polled.size(), limits::kUnreadLookMs);
    if (MonotonicNs() - last_look_ns_ >= limits::kUnreadLookMs * kNsPerMs) {
      EndUnread();
    }
    if (events <= 0) continue;
    if (polled.back().revents != 0) return;
    bool shortage = false;
    for (size_t i = 0; i < sockets_.size(); ++i) {
      if (polled[i].revents != 0) shortage |= !AcceptWaiting(sockets_[i]);
    }
    if (shortage && poll(&polled.back(), 1, kShortageWaitMs) > 0) return;
  }
}

void Acceptor::EndUnread() {
  last_look_ns_ = MonotonicNs();
  const int ended =
      table_.ShutDownUnread(last_look_ns_, limits::kUnreadTimeoutMs * kNsPerMs);
  if (ended > 0) {
    spdlog::warn("closed {} connections whose peers read nothing for {} s",
                 ended, limits::kUnreadTimeoutMs / 1000);
  }
}

bool Acceptor::AcceptWaiting(const ListeningSocket& socket) {
  for (int i = 0; i < kAcceptsPerTurn; ++i) {
    SocketAddress peer;
    peer.length = sizeof(peer.storage);
    FileDescriptor fd(accept4(socket.fd.get(), peer.get(), &peer.length,
                              SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!fd.is_open()) {
      if (errno == EAGAIN) return true;
      // The peer left before it was accepted.
      if (errno == ECONNABORTED || errno == EINTR) continue;
      if (const auto left_out = refusals_.Admit(MonotonicNs())) {
        spdlog::error("cannot accept connections on {}: {}{}", socket.address,
                      std::strerror(errno), LeftOut(*left_out));
      }
      return false;
    }
    if (!IsSelfCheck(peer)) {
      // The permissions of their file guard unix sockets.
      const std::string name =
          peer.is_unix() ? "" : PeerOfHost(peer.HostText());
      const Verdict verdict = table_.Admit(fd.get(), name);
      if (verdict != Verdict::kAdmitted) {
        LogRefusal(verdict, peer);
        continue;
      }
    }
    on_connection_(socket, fd.Release());
  }
  return true;
}

bool Acceptor::IsSelfCheck(const SocketAddress& peer) {
  const std::lock_guard lock(mutex_);
  if (self_check_.length == 0 || !(peer == self_check_)) return false;
  self_check_ = {};
  return true;
}

void Acceptor::LogRefusal(Verdict verdict, const SocketAddress& peer) {
  const auto left_out = refusals_.Admit(MonotonicNs());
  if (!left_out) return;
  const ConnectionTable::Limits& limits = table_.limits();
  if (verdict == Verdict::kTooMany) {
    spdlog::warn("refused a connection from {}: {} are open, the limit{}",
                 peer.HostText(), limits.connections, LeftOut(*left_out));
  } else {
    spdlog::warn("refused a connection from {}: it has {}, the limit{}",
                 peer.HostText(), limits.per_peer, LeftOut(*left_out));
  }
}

}  // namespace tactus::internal::server
