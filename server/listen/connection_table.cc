#include "server/listen/connection_table.h"

#include <linux/sockios.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <vector>

#include "server/ops/clock.h"

namespace tactus::internal::server {
namespace {

constexpr int64_t kLookIntervalNs = 20'000'000;

// 0 if `fd` is not open.
uint64_t InodeOf(int fd) {
  struct stat status;
  return fstat(fd, &status) == 0 ? status.st_ino : 0;
}

}  // namespace

Verdict ConnectionTable::Admit(int fd, const std::string& peer) {
  // The kernel has given the number to a new connection: the old one is over.
  Remove(fd);
  Verdict verdict = Check(peer);
  if (verdict != Verdict::kAdmitted &&
      MonotonicNs() - last_look_ns_ >= kLookIntervalNs) {
    RemoveEnded();
    verdict = Check(peer);
  }
  if (verdict == Verdict::kAdmitted) {
    connections_[fd] = {.inode = InodeOf(fd), .peer = peer};
    if (!peer.empty()) ++per_peer_[peer];
  }
  return verdict;
}

int ConnectionTable::ShutDownUnread(int64_t now_ns, int64_t timeout_ns) {
  int ended = 0;
  for (auto& [fd, connection] : connections_) {
    int bytes = 0;
    const bool waits = InodeOf(fd) == connection.inode &&
                       ioctl(fd, SIOCOUTQ, &bytes) == 0 && bytes > 0;
    if (!waits || bytes != connection.unread_bytes) {
      connection.unread_bytes = waits ? bytes : 0;
      connection.unread_since_ns = now_ns;
    } else if (now_ns - connection.unread_since_ns >= timeout_ns) {
      shutdown(fd, SHUT_RDWR);
      connection.unread_bytes = 0;
      ++ended;
    }
  }
  return ended;
}

void ConnectionTable::ShutDownAll() const {
  for (const auto& [fd, connection] : connections_) {
    if (InodeOf(fd) == connection.inode) shutdown(fd, SHUT_RDWR);
  }
}

Verdict ConnectionTable::Check(const std::string& peer) const {
  if (size() >= limits_.connections) return Verdict::kTooMany;
  const auto found = per_peer_.find(peer);
  return found != per_peer_.end() && found->second >= limits_.per_peer
             ? Verdict::kTooManyOfPeer
             : Verdict::kAdmitted;
}

void ConnectionTable::Remove(int fd) {
  const auto found = connections_.find(fd);
  if (found == connections_.end()) return;
  const auto peer = per_peer_.find(found->second.peer);
  if (peer != per_peer_.end() && --peer->second == 0) per_peer_.erase(peer);
  connections_.erase(found);
}

void ConnectionTable::RemoveEnded() {
  std::vector<int> ended;
  for (const auto& [fd, connection] : connections_) {
    if (InodeOf(fd) != connection.inode) ended.push_back(fd);
  }
  for (const int fd : ended) Remove(fd);
  last_look_ns_ = MonotonicNs();
}

}  // namespace tactus::internal::server
