#include "tools/console/private_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"

namespace tactus::internal::console {
namespace {

namespace fs = std::filesystem;

constexpr absl::string_view kBegin = "tactus-console-";
constexpr int kMostAttempts = 10;

// The locked folder; -1 if it is no folder of this user, or somebody uses it.
int Lock(const std::string& path) {
  const int folder =
      open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder < 0) return -1;
  struct stat own;
  if (fstat(folder, &own) == 0 && own.st_uid == geteuid() &&
      flock(folder, LOCK_EX | LOCK_NB) == 0) {
    return folder;
  }
  close(folder);
  return -1;
}

void Remove(const std::string& path) {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

void RemoveForgotten(const std::string& parent) {
  std::error_code error;
  for (fs::directory_iterator it(parent, error), end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (!absl::StartsWith(name, kBegin)) continue;
    const int lock = Lock(it->path().string());
    if (lock < 0) continue;
    Remove(it->path().string());
    close(lock);
  }
}

// True if the path still names the open folder.
bool Names(const std::string& path, int folder) {
  struct stat named;
  struct stat opened;
  return lstat(path.c_str(), &named) == 0 && fstat(folder, &opened) == 0 &&
         named.st_ino == opened.st_ino && named.st_dev == opened.st_dev;
}

}  // namespace

absl::StatusOr<std::unique_ptr<PrivateFolder>> PrivateFolder::Make(
    const std::string& parent) {
  RemoveForgotten(parent);
  for (int i = 0; i < kMostAttempts; ++i) {
    std::string path = absl::StrCat(parent, "/", kBegin, "XXXXXX");
    if (mkdtemp(path.data()) == nullptr) {
      return IoError(parent, absl::StrCat("no folder can be made in it: ",
                                          std::strerror(errno)));
    }
    const int lock = Lock(path);
    // Another process may have taken it for a forgotten one.
    if (lock >= 0 && Names(path, lock)) {
      return std::unique_ptr<PrivateFolder>(
          new PrivateFolder(std::move(path), lock));
    }
    if (lock >= 0) close(lock);
  }
  return IoError(parent, "folders in it do not stay");
}

PrivateFolder::~PrivateFolder() {
  Remove(path_);
  close(lock_);
}

}  // namespace tactus::internal::console
