#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/store/file_system.h"

namespace tactus::internal {
namespace {

absl::Status ErrorOf(const std::string& path, int error) {
  const std::string text = std::strerror(error);
  if (error != ENOSPC && error != EDQUOT) return IoError(path, text);
  return StorageFull(path, absl::StrCat(text, "; ", kFullDiskAdvice));
}

// The error of reading a file. Trying again does not help where something else
// stands in its place or the disk cannot read it.
absl::Status ReadErrorOf(const std::string& path, int error) {
  switch (error) {
    case ENOENT:
    case ENOTDIR:
      return DataLost(path, "the file does not exist");
    case EISDIR:
    // What opens neither is a socket, or a device without a driver.
    case ENXIO:
      return DataLost(path, "is no regular file");
    case ELOOP:
      return DataLost(path, "is a link, not a file");
    case EIO:
      return DataLost(path, "the disk cannot read it");
    default:
      return ErrorOf(path, error);
  }
}

// Closes its descriptor.
class Descriptor {
 public:
  Descriptor(const std::string& path, int flags)
      : fd_(open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  int get() const { return fd_; }
  bool ok() const { return fd_ >= 0; }

 private:
  int fd_;
};

class PosixAppendableFile final : public AppendableFile {
 public:
  PosixAppendableFile(std::string path, Descriptor fd)
      : path_(std::move(path)), fd_(std::move(fd)) {}

  absl::Status Append(absl::string_view bytes) override {
    while (!bytes.empty()) {
      const ssize_t written = write(fd_.get(), bytes.data(), bytes.size());
      if (written < 0) {
        if (errno == EINTR) continue;
        return ErrorOf(path_, errno);
      }
      bytes.remove_prefix(static_cast<size_t>(written));
    }
    return absl::OkStatus();
  }
  absl::Status Sync() override {
    return fdatasync(fd_.get()) == 0 ? absl::OkStatus() : ErrorOf(path_, errno);
  }
  void DropCache() override {
    // It is advice; nothing depends on it.
    posix_fadvise(fd_.get(), 0, 0, POSIX_FADV_DONTNEED);
  }

 private:
  const std::string path_;
  const Descriptor fd_;
};

class PosixFiles final : public FileSystem {
 public:
  absl::StatusOr<std::unique_ptr<AppendableFile>> Append(
      const std::string& path) override {
    Descriptor fd(path, O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW);
    if (!fd.ok()) return ErrorOf(path, errno);
    return std::make_unique<PosixAppendableFile>(path, std::move(fd));
  }

  absl::StatusOr<std::string> Read(const std::string& path, int64_t offset,
                                   int64_t size) override {
    // A named pipe would wait for its writer.
    const Descriptor fd(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK);
    if (!fd.ok()) return ReadErrorOf(path, errno);
    struct stat info = {};
    if (fstat(fd.get(), &info) != 0) return ErrorOf(path, errno);
    if (!S_ISREG(info.st_mode)) return ReadErrorOf(path, EISDIR);
    std::string bytes(static_cast<size_t>(size), '\0');
    size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t got =
          pread(fd.get(), bytes.data() + done, bytes.size() - done,
                offset + static_cast<int64_t>(done));
      if (got < 0) {
        if (errno == EINTR) continue;
        return ReadErrorOf(path, errno);
      }
      if (got == 0) {
        return DataLost(path, absl::StrCat("ends at byte ", offset + done,
                                           "; it must reach ", offset + size));
      }
      done += static_cast<size_t>(got);
    }
    return bytes;
  }

  absl::StatusOr<int64_t> Size(const std::string& path) override {
    struct stat info;
    if (stat(path.c_str(), &info) == 0) return info.st_size;
    if (errno == ENOENT || errno == ENOTDIR || errno == ELOOP) return -1;
    return ErrorOf(path, errno);
  }

  absl::Status Reserve(const std::string& path, int64_t size) override {
    const Descriptor fd(path, O_RDWR | O_CREAT | O_NOFOLLOW);
    if (!fd.ok()) return ErrorOf(path, errno);
    const int error = posix_fallocate(fd.get(), 0, size);
    return error == 0 ? absl::OkStatus() : ErrorOf(path, error);
  }

  absl::Status Truncate(const std::string& path, int64_t size) override {
    return truncate(path.c_str(), size) == 0 ? absl::OkStatus()
                                             : ErrorOf(path, errno);
  }

  absl::Status Rename(const std::string& from, const std::string& to) override {
    if (rename(from.c_str(), to.c_str()) == 0) return absl::OkStatus();
    if (errno == EISDIR) return DataLost(to, "is a folder, not a file");
    return ErrorOf(to, errno);
  }

  absl::Status Remove(const std::string& path) override {
    return unlink(path.c_str()) == 0 || errno == ENOENT ? absl::OkStatus()
                                                        : ErrorOf(path, errno);
  }

  absl::Status RemoveAll(const std::string& path) override {
    std::error_code error;
    std::filesystem::remove_all(path, error);
    return error ? ErrorOf(path, error.value()) : absl::OkStatus();
  }

  absl::Status MakeDirectory(const std::string& path) override {
    return mkdir(path.c_str(), 0777) == 0 || errno == EEXIST
               ? absl::OkStatus()
               : ErrorOf(path, errno);
  }

  absl::StatusOr<std::vector<std::string>> List(
      const std::string& path) override {
    std::vector<std::string> names;
    std::error_code error;
    for (std::filesystem::directory_iterator it(path, error), end;
         !error && it != end; it.increment(error)) {
      names.push_back(it->path().filename());
    }
    if (error) return ErrorOf(path, error.value());
    std::sort(names.begin(), names.end());
    return names;
  }

  absl::Status SyncDirectory(const std::string& path) override {
    const Descriptor fd(path, O_RDONLY | O_DIRECTORY);
    return fd.ok() && fsync(fd.get()) == 0 ? absl::OkStatus()
                                           : ErrorOf(path, errno);
  }

  absl::Status SyncAll(const std::string& path) override {
    const Descriptor fd(path, O_RDONLY);
    return fd.ok() && syncfs(fd.get()) == 0 ? absl::OkStatus()
                                            : ErrorOf(path, errno);
  }
};

}  // namespace

FileSystem& PosixFileSystem() {
  static PosixFiles files;
  return files;
}

}  // namespace tactus::internal
