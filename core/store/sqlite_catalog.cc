#include "core/store/sqlite_catalog.h"

#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <mutex>
#include <set>
#include <utility>
#include <vector>

#include "SQLiteCpp/Database.h"
#include "SQLiteCpp/Exception.h"
#include "SQLiteCpp/Statement.h"
#include "SQLiteCpp/Transaction.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/store/file_system.h"
#include "core/store/record_seal.h"
#include "core/store/tables.h"

namespace tactus::internal {
namespace {

// Each entry changes the version before it into the next one: entry 0 makes
// version 1 of an empty database. Entries are never changed, only appended.
constexpr std::array<const char*, kCatalogVersion> kMigrations = {
    "CREATE TABLE records ("
    "  kind INTEGER NOT NULL,"
    "  key BLOB NOT NULL,"
    "  value BLOB NOT NULL,"
    "  PRIMARY KEY (kind, key)) WITHOUT ROWID",
    "CREATE TABLE tallies ("
    "  kind INTEGER PRIMARY KEY,"
    "  records INTEGER NOT NULL,"
    "  seals INTEGER NOT NULL)",
};

// Which of them makes the tallies, of the records that there are.
constexpr int kTalliesMigration = 1;

absl::Status ErrorOf(const std::string& path, const SQLite::Exception& error) {
  const std::string text = error.what();
  // The shared memory of the write-ahead log is a file that must grow.
  if (error.getExtendedErrorCode() == SQLITE_IOERR_SHMSIZE) {
    return StorageFull(path, absl::StrCat(text, "; ", kFullDiskAdvice));
  }
  switch (error.getErrorCode()) {
    case SQLITE_FULL:
      return StorageFull(path, absl::StrCat(text, "; ", kFullDiskAdvice));
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
    // The statements are right, so the schema that they meet is not.
    case SQLITE_ERROR:
      return DataLost(path, text);
    default:
      return IoError(path, text);
  }
}

// Runs `body` and makes a status of what SQLite throws.
template <typename Body>
auto Guarded(const std::string& path, const Body& body) -> decltype(body()) {
  try {
    return body();
  } catch (const SQLite::Exception& error) {
    return ErrorOf(path, error);
  }
}

// What defines the tables, as text.
std::string SchemaOf(SQLite::Database& database) {
  SQLite::Statement query(
      database, "SELECT type, name, tbl_name, sql FROM sqlite_master");
  std::string schema;
  while (query.executeStep()) {
    for (int i = 0; i < query.getColumnCount(); ++i) {
      absl::StrAppend(&schema, query.getColumn(i).getString(), "\n");
    }
  }
  return schema;
}

// That of kCatalogVersion.
std::string RightSchema() {
  SQLite::Database made(":memory:",
                        SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  for (const char* migration : kMigrations) made.exec(migration);
  return SchemaOf(made);
}

void Bind(SQLite::Statement& statement, int index, absl::string_view bytes) {
  // A null pointer would be SQL's NULL.
  statement.bind(index, bytes.empty() ? "" : bytes.data(),
                 static_cast<int>(bytes.size()));
}

std::string Text(const SQLite::Column& column) {
  return std::string(static_cast<const char*>(column.getBlob()),
                     static_cast<size_t>(column.getBytes()));
}

// What is known of the records of one table: how many there are, and the sum of
// their seals modulo 2^64.
struct Tally {
  int64_t records = 0;
  uint64_t seals = 0;

  void Add(absl::string_view sealed) { Count(sealed, 1); }
  void Subtract(absl::string_view sealed) { Count(sealed, -1); }
  bool operator==(const Tally&) const = default;

 private:
  // `sealed` ends with the seal.
  void Count(absl::string_view sealed, int sign) {
    RecordSeal seal = 0;
    const size_t size = std::min(sealed.size(), sizeof seal);
    std::memcpy(&seal, sealed.data() + sealed.size() - size, size);
    records += sign;
    seals += static_cast<uint64_t>(sign) * seal;
  }
};

// By the number of the table.
using Tallies = std::map<int, Tally>;

// The tallies of the records that there are.
Tallies CountRecords(SQLite::Database& database) {
  Tallies tallies;
  SQLite::Statement query(
      database, "SELECT kind, substr(CAST(value AS BLOB), -4) FROM records");
  while (query.executeStep()) {
    tallies[query.getColumn(0).getInt()].Add(Text(query.getColumn(1)));
  }
  return tallies;
}

// The tallies of the records that were written.
Tallies WrittenTallies(SQLite::Database& database) {
  Tallies tallies;
  SQLite::Statement query(database, "SELECT kind, records, seals FROM tallies");
  while (query.executeStep()) {
    const Tally tally = {query.getColumn(1).getInt64(),
                         static_cast<uint64_t>(query.getColumn(2).getInt64())};
    if (tally != Tally()) tallies[query.getColumn(0).getInt()] = tally;
  }
  return tallies;
}

void AddTally(SQLite::Database& database, int kind, const Tally& more) {
  SQLite::Statement change(
      database,
      "INSERT INTO tallies VALUES (?1, ?2, ?3) ON CONFLICT (kind) DO "
      "UPDATE SET records = records + ?2, seals = ?4");
  SQLite::Statement query(database, "SELECT seals FROM tallies WHERE kind = ?");
  query.bind(1, kind);
  // SQLite's sums do not wrap around.
  const uint64_t old =
      query.executeStep() ? static_cast<uint64_t>(query.getColumn(0).getInt64())
                          : 0;
  change.bind(1, kind);
  change.bind(2, more.records);
  change.bind(3, static_cast<int64_t>(more.seals));
  change.bind(4, static_cast<int64_t>(old + more.seals));
  change.exec();
}

void ReplaceTallies(SQLite::Database& database) {
  database.exec("DELETE FROM tallies");
  for (const auto& [kind, tally] : CountRecords(database)) {
    AddTally(database, kind, tally);
  }
}

std::string TableName(int kind) {
  for (const auto& [table, name] : kTables) {
    if (static_cast<int>(table) == kind) return name;
  }
  return absl::StrCat("table ", kind);
}

// Where the records differ from those that were written; empty if nowhere.
std::string Differences(SQLite::Database& database) {
  Tallies there = CountRecords(database);
  Tallies written = WrittenTallies(database);
  std::set<int> kinds;
  for (const auto& [kind, tally] : there) kinds.insert(kind);
  for (const auto& [kind, tally] : written) kinds.insert(kind);
  std::vector<std::string> differences;
  for (const int kind : kinds) {
    const Tally& is = there[kind];
    const Tally& was = written[kind];
    if (is == was) continue;
    differences.push_back(
        is.records == was.records
            ? absl::StrCat(TableName(kind), ": records were exchanged")
            : absl::StrCat(TableName(kind), ": ", is.records, " of ",
                           was.records, " records are there"));
  }
  return absl::StrJoin(differences, ", ");
}

class SqliteTransaction final : public Transaction {
 public:
  SqliteTransaction(SQLite::Database& database, const std::string& path)
      : database_(database), path_(path) {}

  absl::StatusOr<std::optional<std::string>> Get(
      Table table, absl::string_view key) const override {
    return Guarded(path_, [&]() -> absl::StatusOr<std::optional<std::string>> {
      SQLite::Statement query(
          database_, "SELECT value FROM records WHERE kind = ? AND key = ?");
      query.bind(1, static_cast<int>(table));
      Bind(query, 2, key);
      if (!query.executeStep()) return std::nullopt;
      return UnsealRecord(table, key, Text(query.getColumn(0)));
    });
  }

  absl::StatusOr<std::vector<CatalogEntry>> Scan(
      Table table, const ScanOptions& options) const override {
    return Guarded(path_, [&]() -> absl::StatusOr<std::vector<CatalogEntry>> {
      const std::string end = EndOfPrefix(options.prefix);
      const bool up = !options.backwards;
      std::string sql = "SELECT key, value FROM records WHERE kind = ?1";
      sql += " AND key >= ?2";
      if (!end.empty()) sql += " AND key < ?3";
      if (!options.after.empty()) sql += up ? " AND key > ?4" : " AND key < ?4";
      absl::StrAppend(&sql, " ORDER BY key ", up ? "ASC" : "DESC", " LIMIT ",
                      options.limit);
      SQLite::Statement query(database_, sql);
      query.bind(1, static_cast<int>(table));
      Bind(query, 2, options.prefix);
      if (!end.empty()) Bind(query, 3, end);
      if (!options.after.empty()) Bind(query, 4, options.after);
      std::vector<CatalogEntry> entries;
      while (query.executeStep()) {
        const std::string key = Text(query.getColumn(0));
        TACTUS_ASSIGN_OR_RETURN(
            const std::string value,
            UnsealRecord(table, key, Text(query.getColumn(1))));
        entries.push_back({key, value});
      }
      return entries;
    });
  }

  absl::Status Put(Table table, absl::string_view key,
                   absl::string_view value) override {
    return Guarded(path_, [&] {
      SubtractOld(table, key);
      SQLite::Statement change(database_,
                               "INSERT OR REPLACE INTO records VALUES (?,?,?)");
      change.bind(1, static_cast<int>(table));
      Bind(change, 2, key);
      const std::string sealed = SealRecord(table, key, value);
      Bind(change, 3, sealed);
      change.exec();
      changes_[static_cast<int>(table)].Add(sealed);
      return absl::OkStatus();
    });
  }

  absl::Status Erase(Table table, absl::string_view key) override {
    return Guarded(path_, [&] {
      SubtractOld(table, key);
      SQLite::Statement change(
          database_, "DELETE FROM records WHERE kind = ? AND key = ?");
      change.bind(1, static_cast<int>(table));
      Bind(change, 2, key);
      change.exec();
      return absl::OkStatus();
    });
  }

  // Before the commit.
  void WriteTallies() {
    for (const auto& [kind, tally] : changes_) {
      AddTally(database_, kind, tally);
    }
  }

 private:
  // The record that is about to be replaced or removed.
  void SubtractOld(Table table, absl::string_view key) {
    SQLite::Statement query(database_,
                            "SELECT substr(CAST(value AS BLOB), -4) FROM "
                            "records WHERE kind = ? AND key = ?");
    query.bind(1, static_cast<int>(table));
    Bind(query, 2, key);
    if (query.executeStep()) {
      changes_[static_cast<int>(table)].Subtract(Text(query.getColumn(0)));
    }
  }

  SQLite::Database& database_;
  const std::string& path_;
  Tallies changes_;
};

class SqliteCatalog final : public Catalog {
 public:
  SqliteCatalog(const std::string& path, const std::string& vfs)
      : path_(path),
        database_(path, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, 0, vfs) {}

  // Brings a new or older database to kCatalogVersion.
  absl::Status Prepare() {
    return Guarded(path_, [&] {
      const int version = database_.execAndGet("PRAGMA user_version").getInt();
      if (version < 0 || version > kCatalogVersion) {
        return DataLost(
            path_, absl::StrCat("has version ", version,
                                "; this program reads 0 to ", kCatalogVersion));
      }
      database_.exec("PRAGMA journal_mode = WAL");
      // A commit is on disk when it returns.
      database_.exec("PRAGMA synchronous = FULL");
      for (int next = version; next < kCatalogVersion; ++next) {
        SQLite::Transaction migration(database_,
                                      SQLite::TransactionBehavior::IMMEDIATE);
        database_.exec(kMigrations[next]);
        if (next == kTalliesMigration) ReplaceTallies(database_);
        database_.exec(absl::StrCat("PRAGMA user_version = ", next + 1));
        migration.commit();
      }
      return absl::OkStatus();
    });
  }

  absl::Status Change(
      absl::FunctionRef<absl::Status(Transaction&)> change) override {
    const std::lock_guard lock(mutex_);
    return Guarded(path_, [&] {
      SQLite::Transaction guard(database_,
                                SQLite::TransactionBehavior::IMMEDIATE);
      SqliteTransaction transaction(database_, path_);
      TACTUS_RETURN_IF_ERROR(change(transaction));
      transaction.WriteTallies();
      guard.commit();
      return absl::OkStatus();
    });
  }

  absl::Status Look(
      absl::FunctionRef<absl::Status(const Transaction&)> look) const override {
    const std::lock_guard lock(mutex_);
    return Guarded(path_, [&] {
      SQLite::Transaction guard(database_);
      const SqliteTransaction transaction(database_, path_);
      return look(transaction);
    });
  }

  absl::Status Check() const override {
    const std::lock_guard lock(mutex_);
    return Guarded(path_, [&] {
      const std::string answer =
          database_.execAndGet("PRAGMA integrity_check").getString();
      if (answer != "ok") return DataLost(path_, answer);
      if (SchemaOf(database_) != RightSchema()) {
        return DataLost(path_, "the schema is not that of a catalogue");
      }
      const std::string differences = Differences(database_);
      if (!differences.empty()) {
        return DataLost(
            path_, absl::StrCat("another program changed it: ", differences));
      }
      return absl::OkStatus();
    });
  }

  absl::Status AcceptRecords() {
    return Guarded(path_, [&] {
      SQLite::Transaction guard(database_,
                                SQLite::TransactionBehavior::IMMEDIATE);
      if (!database_.tableExists("tallies")) {
        database_.exec(kMigrations[kTalliesMigration]);
      }
      ReplaceTallies(database_);
      guard.commit();
      return absl::OkStatus();
    });
  }

 private:
  const std::string path_;
  mutable std::mutex mutex_;
  mutable SQLite::Database database_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Catalog>> OpenSqliteCatalog(
    const std::string& path, const std::string& vfs) {
  return Guarded(path, [&]() -> absl::StatusOr<std::unique_ptr<Catalog>> {
    auto catalog = std::make_unique<SqliteCatalog>(path, vfs);
    TACTUS_RETURN_IF_ERROR(catalog->Prepare());
    return catalog;
  });
}

absl::Status AcceptRecords(const std::string& path) {
  return Guarded(path, [&]() -> absl::Status {
    SqliteCatalog catalog(path, "");
    TACTUS_RETURN_IF_ERROR(catalog.Prepare());
    TACTUS_RETURN_IF_ERROR(catalog.AcceptRecords());
    return catalog.Check();
  });
}

absl::StatusOr<int> CatalogVersionOf(const std::string& path) {
  return Guarded(path, [&]() -> absl::StatusOr<int> {
    SQLite::Database database(path, SQLite::OPEN_READONLY);
    return database.execAndGet("PRAGMA user_version").getInt();
  });
}

}  // namespace tactus::internal
