#include "tests/support/crash_file_system.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::testing {
namespace {

namespace fs = std::filesystem;

std::string FolderOf(const std::string& path) {
  return path.substr(0, path.rfind('/'));
}

std::string BytesOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void WriteBytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace

// Writes through the file system that counts.
class CrashAppendableFile final : public AppendableFile {
 public:
  CrashAppendableFile(CrashFileSystem* files, std::string path,
                      std::unique_ptr<AppendableFile> file)
      : files_(files), path_(std::move(path)), file_(std::move(file)) {}

  absl::Status Append(absl::string_view bytes) override {
    const int64_t size = static_cast<int64_t>(fs::file_size(path_));
    const absl::Status status =
        files_->BeforeWrite(path_, size, static_cast<int64_t>(bytes.size()));
    if (status.ok()) return file_->Append(bytes);
    // A part of a write that fails is on disk.
    TACTUS_RETURN_IF_ERROR(file_->Append(bytes.substr(0, bytes.size() / 2)));
    return status;
  }
  absl::Status Sync() override { return files_->BeforeSync(path_); }

 private:
  CrashFileSystem* const files_;
  const std::string path_;
  const std::unique_ptr<AppendableFile> file_;
};

void CrashFileSystem::StopAt(int count) {
  const std::lock_guard lock(mutex_);
  count_ = 0;
  fail_at_ = count;
  for_ever_ = true;
  error_ = IoError("crash", "the machine has stopped");
}

void CrashFileSystem::FailAt(int count, absl::Status error) {
  const std::lock_guard lock(mutex_);
  count_ = 0;
  fail_at_ = count;
  for_ever_ = false;
  error_ = std::move(error);
}

void CrashFileSystem::Heal() {
  const std::lock_guard lock(mutex_);
  count_ = 0;
  fail_at_ = 0;
}

int CrashFileSystem::operations() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

bool CrashFileSystem::failed() const {
  const std::lock_guard lock(mutex_);
  return fail_at_ > 0 && count_ >= fail_at_;
}

absl::Status CrashFileSystem::Count() {
  ++count_;
  const bool fails =
      fail_at_ > 0 && (for_ever_ ? count_ >= fail_at_ : count_ == fail_at_);
  return fails ? error_ : absl::OkStatus();
}

void CrashFileSystem::Remember(const std::string& path, int64_t offset,
                               int64_t size) {
  Write write;
  write.path = path;
  write.offset = offset;
  write.size = size;
  std::ifstream in(path, std::ios::binary);
  write.old_size = static_cast<int64_t>(fs::file_size(path));
  const int64_t old = std::clamp<int64_t>(write.old_size - offset, 0, size);
  write.old_bytes.resize(static_cast<size_t>(old));
  in.seekg(offset);
  in.read(write.old_bytes.data(), old);
  writes_.push_back(std::move(write));
}

void CrashFileSystem::Undo(const Write& write) {
  if (!fs::exists(write.path)) return;
  {
    std::fstream file(write.path,
                      std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(write.offset);
    file.write(write.old_bytes.data(),
               static_cast<std::streamsize>(write.old_bytes.size()));
  }
  fs::resize_file(write.path, static_cast<uintmax_t>(write.old_size));
}

void CrashFileSystem::ForgetWrites(const std::string& path) {
  writes_.remove_if([&](const Write& write) { return write.path == path; });
}

void CrashFileSystem::Lose(Loss loss) {
  const std::lock_guard lock(mutex_);
  if (loss == Loss::kTorn && !writes_.empty()) {
    Write last = writes_.back();
    const int64_t kept = last.size / 2;
    last.offset += kept;
    last.old_bytes.erase(0, static_cast<size_t>(kept));
    last.old_size = std::max(last.old_size, last.offset);
    if (fs::exists(last.path) &&
        last.old_size <= static_cast<int64_t>(fs::file_size(last.path))) {
      Undo(last);
    }
  }
  if (loss == Loss::kUnsynced || loss == Loss::kNames) {
    for (auto it = writes_.rbegin(); it != writes_.rend(); ++it) Undo(*it);
  }
  if (loss == Loss::kNames) {
    for (auto it = names_.rbegin(); it != names_.rend(); ++it) it->undo();
  }
  writes_.clear();
  names_.clear();
}

absl::StatusOr<std::unique_ptr<AppendableFile>> CrashFileSystem::Append(
    const std::string& path) {
  const bool is_new = !fs::exists(path);
  TACTUS_ASSIGN_OR_RETURN(auto file, PosixFileSystem().Append(path));
  if (is_new) OnCreate(path);
  return std::make_unique<CrashAppendableFile>(this, path, std::move(file));
}

absl::StatusOr<std::string> CrashFileSystem::Read(const std::string& path,
                                                  int64_t offset,
                                                  int64_t size) {
  return PosixFileSystem().Read(path, offset, size);
}

absl::StatusOr<int64_t> CrashFileSystem::Size(const std::string& path) {
  return PosixFileSystem().Size(path);
}

absl::Status CrashFileSystem::Truncate(const std::string& path, int64_t size) {
  TACTUS_RETURN_IF_ERROR(BeforeTruncate(path, size));
  return PosixFileSystem().Truncate(path, size);
}

absl::Status CrashFileSystem::Rename(const std::string& from,
                                     const std::string& to) {
  const std::lock_guard lock(mutex_);
  TACTUS_RETURN_IF_ERROR(Count());
  const bool replaced = fs::exists(to);
  const std::string old = replaced ? BytesOf(to) : "";
  TACTUS_RETURN_IF_ERROR(PosixFileSystem().Rename(from, to));
  ForgetWrites(to);
  for (Write& write : writes_) {
    if (write.path == from) write.path = to;
  }
  names_.push_back({FolderOf(to), [=] {
                      if (!fs::exists(to)) return;
                      fs::rename(to, from);
                      if (replaced) WriteBytes(to, old);
                    }});
  return absl::OkStatus();
}

absl::Status CrashFileSystem::Remove(const std::string& path) {
  TACTUS_RETURN_IF_ERROR(BeforeRemove(path));
  return PosixFileSystem().Remove(path);
}

// It removes what is not needed; nothing depends on it.
absl::Status CrashFileSystem::RemoveAll(const std::string& path) {
  const std::lock_guard lock(mutex_);
  TACTUS_RETURN_IF_ERROR(Count());
  const auto is_in = [&](const std::string& other) {
    return absl::StartsWith(other, path + "/");
  };
  writes_.remove_if([&](const Write& write) { return is_in(write.path); });
  names_.remove_if([&](const Name& name) { return is_in(name.folder + "/"); });
  return PosixFileSystem().RemoveAll(path);
}

absl::Status CrashFileSystem::Reserve(const std::string&, int64_t) {
  return absl::OkStatus();
}

absl::Status CrashFileSystem::MakeDirectory(const std::string& path) {
  return PosixFileSystem().MakeDirectory(path);
}

absl::StatusOr<std::vector<std::string>> CrashFileSystem::List(
    const std::string& path) {
  return PosixFileSystem().List(path);
}

absl::Status CrashFileSystem::SyncDirectory(const std::string& path) {
  const std::lock_guard lock(mutex_);
  TACTUS_RETURN_IF_ERROR(Count());
  names_.remove_if([&](const Name& name) { return name.folder == path; });
  return absl::OkStatus();
}

absl::Status CrashFileSystem::SyncAll(const std::string&) {
  const std::lock_guard lock(mutex_);
  TACTUS_RETURN_IF_ERROR(Count());
  writes_.clear();
  names_.clear();
  return absl::OkStatus();
}

absl::Status CrashFileSystem::BeforeWrite(const std::string& path,
                                          int64_t offset, int64_t size) {
  const std::lock_guard lock(mutex_);
  const absl::Status status = Count();
  // A write that fails may have written a part.
  Remember(path, offset, size);
  return status;
}

absl::Status CrashFileSystem::BeforeTruncate(const std::string& path,
                                             int64_t size) {
  const std::lock_guard lock(mutex_);
  TACTUS_RETURN_IF_ERROR(Count());
  const auto old = static_cast<int64_t>(fs::file_size(path));
  if (old > size) Remember(path, size, old - size);
  return absl::OkStatus();
}

absl::Status CrashFileSystem::BeforeSync(const std::string& path) {
  const std::lock_guard lock(mutex_);
  TACTUS_RETURN_IF_ERROR(Count());
  ForgetWrites(path);
  // SQLite syncs the directory of a new journal too.
  if (absl::EndsWith(path, "-wal") || absl::EndsWith(path, "-journal")) {
    names_.remove_if(
        [&](const Name& name) { return name.folder == FolderOf(path); });
  }
  return absl::OkStatus();
}

absl::Status CrashFileSystem::BeforeRemove(const std::string& path) {
  const std::lock_guard lock(mutex_);
  if (!fs::exists(path)) return absl::OkStatus();
  TACTUS_RETURN_IF_ERROR(Count());
  names_.push_back(
      {FolderOf(path), [path, old = BytesOf(path)] { WriteBytes(path, old); }});
  ForgetWrites(path);
  return absl::OkStatus();
}

void CrashFileSystem::OnCreate(const std::string& path) {
  const std::lock_guard lock(mutex_);
  names_.push_back({FolderOf(path), [path] { fs::remove(path); }});
}

}  // namespace tactus::internal::testing
