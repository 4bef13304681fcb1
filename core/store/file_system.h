// File: file_system.h
//
// FileSystem: the operations on files that storage is built from. Storage gets
// one from its caller, so that tests can stop it at any write, or let any
// operation fail.
//
//   FileSystem& files = PosixFileSystem();
//   TACTUS_ASSIGN_OR_RETURN(auto file, files.Append("blobs/draft"));
//   TACTUS_RETURN_IF_ERROR(file->Append(bytes));
//   TACTUS_RETURN_IF_ERROR(file->Sync());
//
// What was written survives a crash of the machine only after Sync or SyncAll;
// a new name, a rename or a removal only after SyncDirectory or SyncAll.
//
// Errors: IO; STORAGE_FULL if the file system has no room; DATA_LOST if what is
// read does not exist, is shorter, is no regular file, or cannot be read from
// its disk. Thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal {

// A file that grows at its end. Closes when destroyed. Not thread-safe.
class AppendableFile {
 public:
  virtual ~AppendableFile() = default;
  virtual absl::Status Append(absl::string_view bytes) = 0;
  virtual absl::Status Sync() = 0;
  // Frees the memory that caches what is on disk, for bytes that nobody will
  // read soon. Their content does not change.
  virtual void DropCache() {}
};

class FileSystem {
 public:
  virtual ~FileSystem() = default;

  // Opens a file at its end; creates it if it does not exist.
  virtual absl::StatusOr<std::unique_ptr<AppendableFile>> Append(
      const std::string& path) = 0;
  // Returns exactly `size` bytes from `offset` on. Does not follow a link.
  virtual absl::StatusOr<std::string> Read(const std::string& path,
                                           int64_t offset, int64_t size) = 0;
  // Returns the size of a file; -1 if it does not exist, or is a link that
  // leads nowhere.
  virtual absl::StatusOr<int64_t> Size(const std::string& path) = 0;
  // Cuts a file to `size` bytes.
  virtual absl::Status Truncate(const std::string& path, int64_t size) = 0;
  // Makes a file of at least `size` bytes whose room no other file can take.
  virtual absl::Status Reserve(const std::string& path, int64_t size) = 0;
  // Replaces `to` if it exists.
  virtual absl::Status Rename(const std::string& from,
                              const std::string& to) = 0;
  // Removes a file; OK if it does not exist.
  virtual absl::Status Remove(const std::string& path) = 0;
  // Removes a directory and what is in it; OK if it does not exist.
  virtual absl::Status RemoveAll(const std::string& path) = 0;
  // OK if it exists.
  virtual absl::Status MakeDirectory(const std::string& path) = 0;
  // Names in a directory, sorted, without "." and "..".
  virtual absl::StatusOr<std::vector<std::string>> List(
      const std::string& path) = 0;
  virtual absl::Status SyncDirectory(const std::string& path) = 0;
  // Everything written to the file system that holds `path`. Much faster than
  // a Sync of each of many files.
  virtual absl::Status SyncAll(const std::string& path) = 0;
};

// What to do when a data directory's disk is full.
inline constexpr char kFullDiskAdvice[] =
    "delete datasets that nobody needs (trainctl datasets delete), or make the "
    "disk larger";

// The machine's file system. Its STORAGE_FULL comes with kFullDiskAdvice.
FileSystem& PosixFileSystem();

// Returns a whole file of at most `limit` bytes.
absl::StatusOr<std::string> ReadWhole(FileSystem& files,
                                      const std::string& path, int64_t limit);

// Writes `bytes` as `path` + ".draft", and renames it to `path` when it is on
// disk: after a crash `path` is the old file or the new one.
absl::Status WriteAtomically(FileSystem& files, const std::string& path,
                             absl::string_view bytes);

}  // namespace tactus::internal
