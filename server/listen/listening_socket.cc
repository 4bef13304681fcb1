#include "server/listen/listening_socket.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "absl/strings/str_cat.h"
#include "core/base/address.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::server {
namespace {

constexpr int kFlags = SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC;

void SetOption(int fd, int level, int option, int value) {
  setsockopt(fd, level, option, &value, sizeof(value));
}

// 0, or the errno of what failed.
int Bind(const SocketAddress& where, ListeningSocket& listening) {
  listening.fd = FileDescriptor(socket(where.family(), kFlags, 0));
  const int fd = listening.fd.get();
  if (fd < 0) return errno;
  if (!where.is_unix()) {
    SetOption(fd, SOL_SOCKET, SO_REUSEADDR, 1);
    // Accepted connections inherit it: answers must not wait for more data.
    SetOption(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  }
  if (where.family() == AF_INET6) SetOption(fd, IPPROTO_IPV6, IPV6_V6ONLY, 0);
  if (bind(fd, where.get(), where.length) != 0) return errno;
  listening.bound = SocketAddress::OfSocket(fd);
  // The kernel cuts the backlog to net.core.somaxconn.
  return listen(fd, 65'535) == 0 ? 0 : errno;
}

// True if `path` is a unix socket that no process accepts connections from.
bool IsDeserted(const std::string& path, const SocketAddress& where) {
  struct stat status;
  if (stat(path.c_str(), &status) != 0 || !S_ISSOCK(status.st_mode)) {
    return false;
  }
  const FileDescriptor probe(socket(AF_UNIX, kFlags, 0));
  return connect(probe.get(), where.get(), where.length) != 0 &&
         errno == ECONNREFUSED;
}

absl::StatusOr<ListeningSocket> ListenOnUnix(const std::string& address) {
  const std::string path = UnixPath(address);
  sockaddr_un where = {};
  where.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(where.sun_path)) {
    return InvalidConfig("length of the unix socket's path", path.size(),
                         absl::StrCat("1 to ", sizeof(where.sun_path) - 1));
  }
  std::memcpy(where.sun_path, path.data(), path.size());
  SocketAddress full;
  std::memcpy(&full.storage, &where, sizeof(where));
  full.length = sizeof(where);
  if (IsDeserted(path, full)) unlink(path.c_str());
  ListeningSocket listening;
  if (const int error = Bind(full, listening); error != 0) {
    return IoError(address, std::strerror(error));
  }
  listening.address = address;
  return listening;
}

}  // namespace

ListeningSocket::~ListeningSocket() {
  // Only the bound one: the file of another server must stay.
  if (fd.is_open() && bound.is_unix()) unlink(UnixPath(address).c_str());
}

absl::StatusOr<std::vector<ListeningSocket>> ListenOn(
    const std::string& address) {
  std::vector<ListeningSocket> sockets;
  if (IsUnixAddress(address)) {
    TACTUS_ASSIGN_OR_RETURN(sockets.emplace_back(), ListenOnUnix(address));
    return sockets;
  }
  TACTUS_ASSIGN_OR_RETURN(const HostPort at, ParseHostPort(address));
  addrinfo hints = {};
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* list = nullptr;
  const int failed = getaddrinfo(at.host.c_str(), absl::StrCat(at.port).c_str(),
                                 &hints, &list);
  if (failed != 0) return IoError(address, gai_strerror(failed));
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(list,
                                                                 freeaddrinfo);
  int port = at.port;
  int last_error = 0;
  for (const addrinfo* info = list; info != nullptr; info = info->ai_next) {
    SocketAddress where;
    std::memcpy(&where.storage, info->ai_addr, info->ai_addrlen);
    where.length = info->ai_addrlen;
    where.set_port(port);
    ListeningSocket listening;
    last_error = Bind(where, listening);
    // The machine may lack a family that the name resolves to.
    if (last_error == EADDRNOTAVAIL || last_error == EAFNOSUPPORT) continue;
    if (last_error != 0) return IoError(address, std::strerror(last_error));
    port = listening.bound.port();
    listening.address = address;
    sockets.push_back(std::move(listening));
  }
  if (sockets.empty()) return IoError(address, std::strerror(last_error));
  return sockets;
}

}  // namespace tactus::internal::server
