#include "client/drivers/can/can_sockets.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/netlink.h>
#include <linux/can/raw.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

namespace tactus::internal::client {
namespace {

// A second of a full bus.
constexpr int kReceiveBytes = 8 * 1024 * 1024;

int SetOption(int socket, int level, int option, const void* value,
              socklen_t size) {
  return setsockopt(socket, level, option, value, size) == 0 ? 0 : -errno;
}

int Prepare(int socket, unsigned index, std::span<const CanFilter> filters) {
  std::vector<can_filter> list;
  for (const CanFilter& filter : filters) {
    // Standard data frames only.
    list.push_back({.can_id = filter.id,
                    .can_mask = filter.mask | CAN_EFF_FLAG | CAN_RTR_FLAG});
  }
  if (!list.empty()) {
    const int error =
        SetOption(socket, SOL_CAN_RAW, CAN_RAW_FILTER, list.data(),
                  static_cast<socklen_t>(list.size() * sizeof(can_filter)));
    if (error < 0) return error;
  }
  const can_err_mask_t errors = CAN_ERR_MASK;
  int error = SetOption(socket, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors,
                        sizeof(errors));
  if (error < 0) return error;
  const int on = 1;
  error = SetOption(socket, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on));
  if (error < 0) return error;
  error = SetOption(socket, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof(on));
  if (error < 0) return error;
  // As much as the kernel grants.
  SetOption(socket, SOL_SOCKET, SO_RCVBUF, &kReceiveBytes,
            sizeof(kReceiveBytes));
  sockaddr_can address = {};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(index);
  if (bind(socket, reinterpret_cast<sockaddr*>(&address), sizeof(address))) {
    return -errno;
  }
  return 0;
}

// Appends an attribute to a netlink message and returns it.
rtattr* Append(nlmsghdr* message, uint16_t type, const void* data,
               size_t size) {
  auto* attribute = reinterpret_cast<rtattr*>(reinterpret_cast<char*>(message) +
                                              NLMSG_ALIGN(message->nlmsg_len));
  attribute->rta_type = type;
  attribute->rta_len = static_cast<uint16_t>(RTA_LENGTH(size));
  if (size > 0) std::memcpy(RTA_DATA(attribute), data, size);
  message->nlmsg_len = static_cast<uint32_t>(NLMSG_ALIGN(message->nlmsg_len) +
                                             RTA_ALIGN(attribute->rta_len));
  return attribute;
}

void EndNest(const nlmsghdr* message, rtattr* nest) {
  nest->rta_len = static_cast<uint16_t>(reinterpret_cast<const char*>(message) +
                                        message->nlmsg_len -
                                        reinterpret_cast<const char*>(nest));
}

class SystemCanSockets : public CanSockets {
 public:
  int Open(const std::string& interface,
           std::span<const CanFilter> filters) override {
    const int socket =
        ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    if (socket < 0) return -errno;
    const unsigned index = if_nametoindex(interface.c_str());
    const int error = index == 0 ? -errno : Prepare(socket, index, filters);
    if (error == 0) return socket;
    ::close(socket);
    return error;
  }

  void Close(int socket) override { ::close(socket); }

  int Wait(int socket, int64_t timeout_ns) override {
    pollfd poll = {.fd = socket, .events = POLLIN, .revents = 0};
    const timespec timeout = {
        .tv_sec = static_cast<time_t>(timeout_ns / 1'000'000'000),
        .tv_nsec = static_cast<long>(timeout_ns % 1'000'000'000)};
    const int ready = ppoll(&poll, 1, &timeout, nullptr);
    if (ready < 0) return errno == EINTR ? 0 : -errno;
    return ready;
  }

  int Read(int socket, Message& message) override {
    alignas(cmsghdr) char control[256];
    iovec part = {.iov_base = message.bytes.data(),
                  .iov_len = message.bytes.size()};
    msghdr header = {};
    header.msg_iov = &part;
    header.msg_iovlen = 1;
    header.msg_control = control;
    header.msg_controllen = sizeof(control);
    const ssize_t size = recvmsg(socket, &header, 0);
    if (size < 0) {
      return errno == EAGAIN || errno == EINTR ? 0 : -errno;
    }
    message.size = static_cast<size_t>(size);
    message.realtime_ns = 0;
    for (cmsghdr* c = CMSG_FIRSTHDR(&header); c != nullptr;
         c = CMSG_NXTHDR(&header, c)) {
      if (c->cmsg_level != SOL_SOCKET) continue;
      if (c->cmsg_type == SO_TIMESTAMPNS) {
        timespec time;
        std::memcpy(&time, CMSG_DATA(c), sizeof(time));
        message.realtime_ns =
            int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
      } else if (c->cmsg_type == SO_RXQ_OVFL) {
        std::memcpy(&message.dropped, CMSG_DATA(c), sizeof(message.dropped));
      }
    }
    return 1;
  }

  int Write(int socket, std::span<const uint8_t> bytes) override {
    const ssize_t written = ::write(socket, bytes.data(), bytes.size());
    return written < 0 ? -errno : 0;
  }

  // What `ip link set can0 type can restart` sends.
  int Restart(const std::string& interface) override {
    const unsigned index = if_nametoindex(interface.c_str());
    if (index == 0) return -errno;
    const int socket =
        ::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
    if (socket < 0) return -errno;
    alignas(nlmsghdr) char buffer[512] = {};
    auto* message = reinterpret_cast<nlmsghdr*>(buffer);
    message->nlmsg_len = NLMSG_LENGTH(sizeof(ifinfomsg));
    message->nlmsg_type = RTM_NEWLINK;
    message->nlmsg_flags = NLM_F_REQUEST | NLM_F_ACK;
    static_cast<ifinfomsg*>(NLMSG_DATA(message))->ifi_index =
        static_cast<int>(index);
    rtattr* info = Append(message, IFLA_LINKINFO, nullptr, 0);
    Append(message, IFLA_INFO_KIND, "can", 3);
    rtattr* data = Append(message, IFLA_INFO_DATA, nullptr, 0);
    const uint32_t restart = 1;
    Append(message, IFLA_CAN_RESTART, &restart, sizeof(restart));
    EndNest(message, data);
    EndNest(message, info);
    int error = 0;
    alignas(nlmsghdr) char answer[1024];
    if (send(socket, buffer, message->nlmsg_len, 0) < 0 ||
        recv(socket, answer, sizeof(answer), 0) < 0) {
      error = -errno;
    } else {
      const auto* header = reinterpret_cast<const nlmsghdr*>(answer);
      if (header->nlmsg_type == NLMSG_ERROR) {
        error = static_cast<const nlmsgerr*>(NLMSG_DATA(header))->error;
      }
    }
    ::close(socket);
    return error;
  }

  int64_t RealtimeNs() override {
    timespec time;
    clock_gettime(CLOCK_REALTIME, &time);
    return int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
  }
};

}  // namespace

CanSockets& CanSockets::System() {
  static auto* const sockets = new SystemCanSockets();
  return *sockets;
}

}  // namespace tactus::internal::client
