// File: crash_vfs.h
//
// CrashVfs: a file layer of SQLite whose writes, truncations, syncs and
// removals are counted, and fail, as a CrashFileSystem says.
//
//   CrashFileSystem files;
//   CrashVfs vfs(&files);
//   auto catalog = OpenSqliteCatalog(path, vfs.name());
//
// It is registered while it lives. SQLite syncs the directory of a new journal
// with its first sync; so does this.
#pragma once

#include <sqlite3.h>

#include <string>

#include "tests/support/crash_file_system.h"

namespace tactus::internal::testing {

class CrashVfs {
 public:
  explicit CrashVfs(CrashFileSystem* files);
  ~CrashVfs();
  CrashVfs(const CrashVfs&) = delete;
  CrashVfs& operator=(const CrashVfs&) = delete;

  const std::string& name() const { return name_; }

 private:
  const std::string name_;
  sqlite3_vfs vfs_;
};

}  // namespace tactus::internal::testing
