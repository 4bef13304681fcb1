// File: old_directory.h
//
// A data directory as release 0.1.0 left it.
//
//   MakeOldDirectory(path);
//   EXPECT_TRUE(DataDirectory::Open(PosixFileSystem(), path).ok());
#pragma once

#include <sqlite3.h>

#include <filesystem>
#include <string>

#include "gtest/gtest.h"

namespace tactus::internal::server {

// Runs `sql` on the catalogue of the data directory `path`.
inline void RunSql(const std::string& path, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((path + "/catalog.db").c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr),
            SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
}

// Makes the data directory `path` old.
inline void MakeOldDirectory(const std::string& path) {
  RunSql(path,
         "DROP TABLE tallies; DELETE FROM records WHERE kind = 14; "
         "PRAGMA user_version = 1");
  std::filesystem::remove(path + "/marker");
  std::filesystem::remove(path + "/reserve");
}

}  // namespace tactus::internal::server
