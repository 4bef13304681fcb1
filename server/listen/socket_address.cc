#include "server/listen/socket_address.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <cstring>

namespace tactus::internal::server {
namespace {

template <typename Address>
Address As(const sockaddr_storage& storage) {
  Address address;
  std::memcpy(&address, &storage, sizeof(address));
  return address;
}

}  // namespace

SocketAddress SocketAddress::OfPeer(int fd) {
  SocketAddress address;
  address.length = sizeof(address.storage);
  if (getpeername(fd, address.get(), &address.length) != 0) return {};
  return address;
}

SocketAddress SocketAddress::OfSocket(int fd) {
  SocketAddress address;
  address.length = sizeof(address.storage);
  if (getsockname(fd, address.get(), &address.length) != 0) return {};
  return address;
}

int SocketAddress::port() const {
  // The port has the same place in both families.
  if (family() != AF_INET && family() != AF_INET6) return 0;
  return ntohs(As<sockaddr_in>(storage).sin_port);
}

void SocketAddress::set_port(int port) {
  sockaddr_in address = As<sockaddr_in>(storage);
  address.sin_port = htons(static_cast<uint16_t>(port));
  std::memcpy(&storage, &address, sizeof(address));
}

SocketAddress SocketAddress::Reachable() const {
  SocketAddress reachable = *this;
  if (family() == AF_INET) {
    sockaddr_in address = As<sockaddr_in>(storage);
    if (address.sin_addr.s_addr == htonl(INADDR_ANY)) {
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    }
    std::memcpy(&reachable.storage, &address, sizeof(address));
  } else if (family() == AF_INET6) {
    sockaddr_in6 address = As<sockaddr_in6>(storage);
    if (IN6_IS_ADDR_UNSPECIFIED(&address.sin6_addr)) {
      address.sin6_addr = in6addr_loopback;
    }
    std::memcpy(&reachable.storage, &address, sizeof(address));
  }
  return reachable;
}

std::string SocketAddress::HostText() const {
  char text[INET6_ADDRSTRLEN] = "";
  if (family() == AF_INET) {
    const in_addr host = As<sockaddr_in>(storage).sin_addr;
    inet_ntop(AF_INET, &host, text, sizeof(text));
  } else if (family() == AF_INET6) {
    const in6_addr host = As<sockaddr_in6>(storage).sin6_addr;
    inet_ntop(AF_INET6, &host, text, sizeof(text));
  } else {
    return "a unix socket";
  }
  return text;
}

bool SocketAddress::operator==(const SocketAddress& other) const {
  return length == other.length &&
         std::memcmp(&storage, &other.storage, length) == 0;
}

}  // namespace tactus::internal::server
