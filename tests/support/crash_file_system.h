// File: crash_file_system.h
//
// CrashFileSystem: the machine's file system with a fault at a chosen
// operation, and what a crash of the machine leaves behind. It counts what
// changes the disk: writes, syncs, renames, removals, truncations. Of a SQLite
// database it learns through CrashVfs (crash_vfs.h).
//
//   CrashFileSystem files;
//   files.StopAt(7);                // this operation and all later ones fail
//   Work(files);
//   files.Lose(CrashFileSystem::Loss::kUnsynced);  // the machine has crashed
//   files.Heal();
//   Reopen(files);
//
// Nothing is synced for real. Thread-safe; Lose only while nobody writes.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/store/file_system.h"

namespace tactus::internal::testing {

class CrashFileSystem final : public FileSystem {
 public:
  // What is gone after a crash, beside the operations that failed.
  enum class Loss {
    kNothing,
    // Bytes that were written and not synced.
    kUnsynced,
    // The second half of the last write, if it was not synced.
    kTorn,
    // Bytes as above, and new names, renames and removals in directories that
    // were not synced.
    kNames,
  };
  static constexpr Loss kLosses[] = {Loss::kNothing, Loss::kUnsynced,
                                     Loss::kTorn, Loss::kNames};

  // Fails operation number `count` (from 1, since now) and all later ones.
  void StopAt(int count);
  // Fails only operation number `count`, with `error`.
  void FailAt(int count, absl::Status error);
  // Lets all operations succeed, and counts from 0.
  void Heal();
  // Operations since StopAt, FailAt or Heal.
  int operations() const;
  // True if the operation was reached that was to fail.
  bool failed() const;

  // Changes the files as a crash of the machine would.
  void Lose(Loss loss);

  absl::StatusOr<std::unique_ptr<AppendableFile>> Append(
      const std::string& path) override;
  absl::StatusOr<std::string> Read(const std::string& path, int64_t offset,
                                   int64_t size) override;
  absl::StatusOr<int64_t> Size(const std::string& path) override;
  absl::Status Truncate(const std::string& path, int64_t size) override;
  // Takes no room: tests of crashes open a thousand directories.
  absl::Status Reserve(const std::string& path, int64_t size) override;
  absl::Status Rename(const std::string& from, const std::string& to) override;
  absl::Status Remove(const std::string& path) override;
  absl::Status RemoveAll(const std::string& path) override;
  absl::Status MakeDirectory(const std::string& path) override;
  absl::StatusOr<std::vector<std::string>> List(
      const std::string& path) override;
  absl::Status SyncDirectory(const std::string& path) override;
  absl::Status SyncAll(const std::string& path) override;

  // For a file that something else writes: call them before the change is made.
  // OK if it may be made.
  absl::Status BeforeWrite(const std::string& path, int64_t offset,
                           int64_t size);
  absl::Status BeforeTruncate(const std::string& path, int64_t size);
  absl::Status BeforeSync(const std::string& path);
  absl::Status BeforeRemove(const std::string& path);
  void OnCreate(const std::string& path);

 private:
  // What undoes one write.
  struct Write {
    std::string path;
    int64_t offset = 0;
    int64_t size = 0;
    std::string old_bytes;
    int64_t old_size = 0;
  };
  // What undoes the change of a directory.
  struct Name {
    std::string folder;
    std::function<void()> undo;
  };

  // With the lock: counts one operation.
  absl::Status Count();
  void Remember(const std::string& path, int64_t offset, int64_t size);
  static void Undo(const Write& write);
  void ForgetWrites(const std::string& path);

  mutable std::mutex mutex_;
  int count_ = 0;
  int fail_at_ = 0;
  bool for_ever_ = false;
  absl::Status error_;
  // Not synced, the oldest first.
  std::list<Write> writes_;
  std::list<Name> names_;
};

}  // namespace tactus::internal::testing
