#include "core/store/directory_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/base/errors.h"

namespace tactus {

absl::StatusOr<std::unique_ptr<DirectoryLock>> DirectoryLock::Take(
    const std::string& folder) {
  const std::string path = folder + "/lock";
  const int fd = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (fd < 0) return IoError(path, std::strerror(errno));
  if (flock(fd, LOCK_EX | LOCK_NB) == 0) {
    return std::unique_ptr<DirectoryLock>(new DirectoryLock(fd));
  }
  const bool taken = errno == EWOULDBLOCK;
  const std::string error = std::strerror(errno);
  close(fd);
  return IoError(path,
                 taken ? "another process uses this data directory" : error);
}

DirectoryLock::~DirectoryLock() { close(fd_); }

}  // namespace tactus
