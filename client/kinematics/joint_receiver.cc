#include "client/kinematics/joint_receiver.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/kinematics/joint_line.h"
#include "core/base/address.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

// More than any sample has.
constexpr size_t kMaxDatagramBytes = 4096;
// How soon the thread notices that it must end.
constexpr int kPollMs = 50;

int PortOf(int socket) {
  sockaddr_storage address = {};
  socklen_t size = sizeof(address);
  if (getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    return 0;
  }
  return ntohs(address.ss_family == AF_INET6
                   ? reinterpret_cast<sockaddr_in6*>(&address)->sin6_port
                   : reinterpret_cast<sockaddr_in*>(&address)->sin_port);
}

}  // namespace

absl::StatusOr<std::unique_ptr<JointReceiver>> JointReceiver::Listen(
    const std::string& address, JointPoses* poses, Clock* clock) {
  TACTUS_ASSIGN_OR_RETURN(const HostPort at, ParseHostPort(address));
  addrinfo hints = {};
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(at.host.c_str(), absl::StrCat(at.port).c_str(),
                                &hints, &found);
  if (error != 0) return IoError(address, gai_strerror(error));
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> list(found,
                                                                &freeaddrinfo);
  const int socket =
      ::socket(list->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket < 0) return IoError(address, std::strerror(errno));
  if (bind(socket, list->ai_addr, list->ai_addrlen) != 0) {
    const absl::Status status = IoError(address, std::strerror(errno));
    close(socket);
    return status;
  }
  return std::unique_ptr<JointReceiver>(
      new JointReceiver(socket, PortOf(socket), poses, clock));
}

JointReceiver::JointReceiver(int socket, int port, JointPoses* poses,
                             Clock* clock)
    : socket_(socket),
      port_(port),
      poses_(poses),
      clock_(clock),
      thread_([this] { ReceiveAll(); }) {}

JointReceiver::~JointReceiver() {
  stop_ = true;
  thread_.join();
  close(socket_);
}

JointReceiver::Statistics JointReceiver::statistics() const {
  const std::lock_guard lock(mutex_);
  return statistics_;
}

absl::Status JointReceiver::Take(absl::string_view line,
                                 std::span<double> values) {
  int64_t time_ns = 0;
  TACTUS_RETURN_IF_ERROR(ParseJointLine(line, time_ns, values));
  const int64_t now_ns = clock_->NowNs();
  if (time_ns == 0) time_ns = now_ns;
  if (time_ns < now_ns - kMaxClockDifferenceNs ||
      time_ns > now_ns + kMaxClockDifferenceNs) {
    return InvalidConfig(
        "time of the joint values", time_ns,
        absl::StrCat("on CLOCK_MONOTONIC of this host, where it is ", now_ns,
                     ", or 0 for the time of receipt"));
  }
  return poses_->Push(time_ns, values);
}

void JointReceiver::ReceiveAll() {
  std::array<char, kMaxDatagramBytes + 1> buffer;
  std::vector<double> values(poses_->joints());
  while (!stop_) {
    pollfd poll = {.fd = socket_, .events = POLLIN, .revents = 0};
    if (::poll(&poll, 1, kPollMs) <= 0) continue;
    const ssize_t count = recv(socket_, buffer.data(), buffer.size(), 0);
    if (count < 0) continue;
    const auto size = static_cast<size_t>(count);
    const absl::Status status =
        size <= kMaxDatagramBytes
            ? Take({buffer.data(), size}, values)
            : InvalidConfig("bytes of a datagram", size,
                            absl::StrCat("at most ", kMaxDatagramBytes));
    const std::lock_guard lock(mutex_);
    ++(status.ok() ? statistics_.taken : statistics_.refused);
    statistics_.refusing = !status.ok();
    if (!status.ok()) statistics_.last_refusal = std::string(status.message());
  }
}

}  // namespace tactus::internal::client
