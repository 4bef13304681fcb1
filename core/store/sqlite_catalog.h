// File: sqlite_catalog.h
//
// SqliteCatalog: a Catalog in one SQLite database with a write-ahead log. Each
// transaction also counts the records of each table and adds up their
// checksums, so that a record that another program removed is missed.
//
//   TACTUS_ASSIGN_OR_RETURN(auto catalog, OpenSqliteCatalog("catalog.db"));
//
// The database may be copied while it is in use with `sqlite3 catalog.db
// ".backup copy.db"`.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "core/store/catalog.h"

namespace tactus::internal {

// The format that this program writes: SQLite's user_version.
inline constexpr int kCatalogVersion = 2;

// Opens a database, or creates it; migrates an older version. `vfs`: SQLite's
// name of the file layer to use; empty means the default. IO; DATA_LOST if the
// file is no catalogue, is damaged or has a newer version.
absl::StatusOr<std::unique_ptr<Catalog>> OpenSqliteCatalog(
    const std::string& path, const std::string& vfs = "");

// Takes the records of the catalogue at `path` as those that were written. IO;
// DATA_LOST if the file is no catalogue or is damaged.
absl::Status AcceptRecords(const std::string& path);

// The version of the catalogue at `path`, which stays as it is. IO; DATA_LOST
// if the file is no database.
absl::StatusOr<int> CatalogVersionOf(const std::string& path);

}  // namespace tactus::internal
