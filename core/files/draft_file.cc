#include "core/files/draft_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

// Names of earlier drafts that may be in the way, left by programs that died.
constexpr int kMaxAttempts = 1000;

std::string Errno() { return std::strerror(errno); }

absl::Status Sync(const std::string& path, int flags) {
  const int fd = open(path.c_str(), flags | O_CLOEXEC);
  if (fd < 0) return IoError(path, Errno());
  const bool ok = fsync(fd) == 0;
  const std::string error = Errno();
  close(fd);
  return ok ? absl::OkStatus() : IoError(path, error);
}

std::string FolderOf(const std::string& path) {
  const size_t slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

}  // namespace

DraftFile::DraftFile(std::string target, std::string path)
    : target_(std::move(target)), path_(std::move(path)) {}

DraftFile::DraftFile(DraftFile&& other) noexcept { *this = std::move(other); }

DraftFile& DraftFile::operator=(DraftFile&& other) noexcept {
  std::swap(target_, other.target_);
  std::swap(path_, other.path_);
  return *this;
}

DraftFile::~DraftFile() {
  if (!path_.empty()) unlink(path_.c_str());
}

absl::StatusOr<DraftFile> DraftFile::Create(const std::string& target) {
  struct stat info;
  if (stat(target.c_str(), &info) == 0 && !S_ISREG(info.st_mode)) {
    return IoError(target, "exists and is not a regular file");
  }
  static std::atomic<unsigned> drafts = 0;
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    std::string path =
        absl::StrCat(target, ".", getpid(), "-", drafts++, ".tmp");
    // Never follows a link, never takes a file that is there.
    const int fd =
        open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd >= 0) {
      close(fd);
      return DraftFile(target, std::move(path));
    }
    if (errno != EEXIST) break;
  }
  return IoError(target, absl::StrCat("cannot be created: ", Errno()));
}

absl::Status DraftFile::Publish() {
  TACTUS_RETURN_IF_ERROR(Sync(path_, O_RDONLY));
  if (rename(path_.c_str(), target_.c_str()) != 0) {
    return IoError(target_, Errno());
  }
  path_.clear();
  return Sync(FolderOf(target_), O_RDONLY | O_DIRECTORY);
}

absl::Status WriteFileBytes(const std::string& path, absl::string_view bytes) {
  TACTUS_ASSIGN_OR_RETURN(DraftFile draft, DraftFile::Create(path));
  std::ofstream file(draft.path(), std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) return IoError(path, "cannot be written");
  return draft.Publish();
}

}  // namespace tactus::internal
