#include "server/ops/service_notify.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "core/base/errors.h"

namespace tactus::internal::server {

absl::Status NotifyService(absl::string_view state) {
  const char* path = std::getenv("NOTIFY_SOCKET");
  if (path == nullptr || *path == '\0') return absl::OkStatus();
  sockaddr_un where = {};
  where.sun_family = AF_UNIX;
  const size_t size = std::strlen(path);
  if (size >= sizeof(where.sun_path)) return IoError(path, "too long");
  std::memcpy(where.sun_path, path, size);
  // A leading @ stands for an abstract name, which begins with a zero byte.
  if (where.sun_path[0] == '@') where.sun_path[0] = '\0';
  const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return IoError(path, std::strerror(errno));
  const ssize_t sent =
      sendto(fd, state.data(), state.size(), MSG_NOSIGNAL,
             reinterpret_cast<const sockaddr*>(&where),
             static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + size));
  const int error = errno;
  close(fd);
  return sent < 0 ? IoError(path, std::strerror(error)) : absl::OkStatus();
}

}  // namespace tactus::internal::server
