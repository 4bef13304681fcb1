// File: watched_files.h
//
// WatchedFiles: the machine's file system, which looks at the size of a folder
// after each change of it, and does something before a file is read.
//
//   WatchedFiles files(folder);
//   files.before_read = [&] { Change(files); };
//   Work(files);
//   EXPECT_LE(files.most_bytes(), limit);
//
// Not thread-safe. Test-only.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/status_macros.h"
#include "core/store/file_system.h"
#include "tests/server/contact_log/ring_records.h"

namespace tactus::internal::server {

class WatchedFiles final : public FileSystem {
 public:
  explicit WatchedFiles(std::string folder) : folder_(std::move(folder)) {}

  std::function<void()> before_read = [] {};

  // The most that its files had at any time.
  int64_t most_bytes() const { return most_bytes_; }

  absl::StatusOr<std::unique_ptr<AppendableFile>> Append(
      const std::string& path) override {
    TACTUS_ASSIGN_OR_RETURN(auto file, files_.Append(path));
    return std::make_unique<File>(*this, std::move(file));
  }
  absl::StatusOr<std::string> Read(const std::string& path, int64_t offset,
                                   int64_t size) override {
    before_read();
    return files_.Read(path, offset, size);
  }
  absl::StatusOr<int64_t> Size(const std::string& path) override {
    return files_.Size(path);
  }
  absl::Status Truncate(const std::string& path, int64_t size) override {
    return Looked(files_.Truncate(path, size));
  }
  absl::Status Reserve(const std::string& path, int64_t size) override {
    return Looked(files_.Reserve(path, size));
  }
  absl::Status Rename(const std::string& from, const std::string& to) override {
    return Looked(files_.Rename(from, to));
  }
  absl::Status Remove(const std::string& path) override {
    return Looked(files_.Remove(path));
  }
  absl::Status RemoveAll(const std::string& path) override {
    return Looked(files_.RemoveAll(path));
  }
  absl::Status MakeDirectory(const std::string& path) override {
    return files_.MakeDirectory(path);
  }
  absl::StatusOr<std::vector<std::string>> List(
      const std::string& path) override {
    return files_.List(path);
  }
  absl::Status SyncDirectory(const std::string&) override { return {}; }
  absl::Status SyncAll(const std::string&) override { return {}; }

 private:
  class File final : public AppendableFile {
   public:
    File(WatchedFiles& files, std::unique_ptr<AppendableFile> file)
        : files_(files), file_(std::move(file)) {}
    absl::Status Append(absl::string_view bytes) override {
      return files_.Looked(file_->Append(bytes));
    }
    absl::Status Sync() override { return {}; }

   private:
    WatchedFiles& files_;
    const std::unique_ptr<AppendableFile> file_;
  };

  absl::Status Looked(absl::Status status) {
    most_bytes_ = std::max(most_bytes_, FolderBytes(folder_));
    return status;
  }

  const std::string folder_;
  FileSystem& files_ = PosixFileSystem();
  int64_t most_bytes_ = 0;
};

}  // namespace tactus::internal::server
