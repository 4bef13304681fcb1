#include "core/store/directory_lock.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <set>

#include "absl/strings/match.h"
#include "absl/synchronization/mutex.h"
#include "core/base/errors.h"

namespace tactus::internal {
namespace {

// The locks of this process. The kernel would grant it a second one on the same
// file, and would end both with the first descriptor that it closes.
struct OwnLocks {
  absl::Mutex mutex;
  std::set<DirectoryLock::FileId> files ABSL_GUARDED_BY(mutex);
};

OwnLocks& Own() {
  static OwnLocks* const own = new OwnLocks;
  return *own;
}

DirectoryLock::FileId IdOf(const struct stat& file) {
  return {file.st_dev, file.st_ino};
}

constexpr char kInUse[] = "another process uses this data directory";

absl::Status InUse(const std::string& path) { return IoError(path, kInUse); }

}  // namespace

absl::StatusOr<std::unique_ptr<DirectoryLock>> DirectoryLock::Take(
    const std::string& folder) {
  const std::string path = folder + "/lock";
  OwnLocks& own = Own();
  absl::MutexLock guard(&own.mutex);
  struct stat file = {};
  if (stat(path.c_str(), &file) == 0 && own.files.contains(IdOf(file))) {
    return InUse(path);
  }
  const int fd = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (fd < 0) return IoError(path, std::strerror(errno));
  // A lock of fcntl belongs to the process alone. One of flock would belong to
  // its forked children too: a job's process that has not reached its program
  // yet would hold the lock of a server that was killed.
  struct flock all = {};
  all.l_type = F_WRLCK;
  all.l_whence = SEEK_SET;
  if (fcntl(fd, F_SETLK, &all) == 0 && fstat(fd, &file) == 0) {
    own.files.insert(IdOf(file));
    return std::unique_ptr<DirectoryLock>(new DirectoryLock(fd, IdOf(file)));
  }
  const int error = errno;
  close(fd);
  if (error == EACCES || error == EAGAIN) return InUse(path);
  return IoError(path, std::strerror(error));
}

bool DirectoryLock::IsInUse(const absl::Status& status) {
  return absl::EndsWith(status.message(), kInUse);
}

DirectoryLock::~DirectoryLock() {
  OwnLocks& own = Own();
  absl::MutexLock guard(&own.mutex);
  close(fd_);
  own.files.erase(file_);
}

}  // namespace tactus::internal
