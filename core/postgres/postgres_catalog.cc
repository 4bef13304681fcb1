#include "core/postgres/postgres_catalog.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits_catalog.h"
#include "core/base/status_macros.h"
#include "core/postgres/pg_connection.h"
#include "core/store/record_seal.h"
#include "core/store/tables.h"

namespace tactus::internal {
namespace {

using Clock = std::chrono::steady_clock;

// Each entry changes the version before it into the next one: entry 0 makes
// version 1 of an empty database. Entries are never changed, only appended. One
// that the release before can live with leaves kOldestPostgresVersion.
constexpr const char* kPostgresMigrations[kPostgresVersion] = {
    "CREATE TABLE tactus_records ("
    "  kind integer NOT NULL,"
    "  key bytea NOT NULL,"
    "  value bytea NOT NULL,"
    "  PRIMARY KEY (kind, key))",
};
// Held by who changes the schema.
constexpr char kSchemaLock[] = "SELECT pg_advisory_xact_lock(7414871)";
constexpr int kRecordsPerCheck = 1'000;

// What another transaction has made impossible, and a second try mends.
bool IsConflict(const std::string& sqlstate) {
  constexpr const char* kStates[] = {"40001", "40P01", "23505", "55P03"};
  return std::ranges::find(kStates, sqlstate) != std::end(kStates);
}

enum class News { kNone, kOfReplicas, kOfAll };

// The statement that tells it, behind another one's columns.
std::string Telling(News news) {
  if (news == News::kNone) return "";
  return absl::StrCat(", pg_notify('tactus', '",
                      news == News::kOfReplicas ? kNewsOfReplicas : "", "')");
}

class PostgresTransaction final : public Transaction {
 public:
  explicit PostgresTransaction(PgConnection& connection)
      : connection_(connection) {}

  absl::StatusOr<std::optional<std::string>> Get(
      Table table, absl::string_view key) const override {
    TACTUS_ASSIGN_OR_RETURN(
        const PgRows rows,
        Run("SELECT value FROM tactus_records WHERE kind = $1 AND key = $2",
            {KindOf(table), PgBytes(key)}));
    if (rows.size() == 0) return std::nullopt;
    return UnsealRecord(table, key, std::string(rows.Bytes(0, 0)));
  }

  absl::StatusOr<std::vector<CatalogEntry>> Scan(
      Table table, const ScanOptions& options) const override {
    const std::string end = EndOfPrefix(options.prefix);
    const bool up = !options.backwards;
    std::string sql =
        "SELECT key, value FROM tactus_records WHERE kind = $1 AND key >= $2";
    std::vector<PgValue> values = {KindOf(table), PgBytes(options.prefix)};
    const auto bound = [&](const char* comparison, absl::string_view key) {
      values.push_back(PgBytes(key));
      absl::StrAppend(&sql, " AND key ", comparison, " $", values.size());
    };
    if (!end.empty()) bound("<", end);
    if (!options.after.empty()) bound(up ? ">" : "<", options.after);
    absl::StrAppend(&sql, " ORDER BY key ", up ? "ASC" : "DESC", " LIMIT ",
                    options.limit);
    TACTUS_ASSIGN_OR_RETURN(const PgRows rows, Run(sql, values));
    std::vector<CatalogEntry> entries;
    entries.reserve(rows.size());
    for (int row = 0; row < rows.size(); ++row) {
      const absl::string_view key = rows.Bytes(row, 0);
      TACTUS_ASSIGN_OR_RETURN(
          std::string value,
          UnsealRecord(table, key, std::string(rows.Bytes(row, 1))));
      entries.push_back({std::string(key), std::move(value)});
    }
    return entries;
  }

  absl::Status Put(Table table, absl::string_view key,
                   absl::string_view value) override {
    Note(table, table == Table::kReplicas ? News::kOfReplicas : News::kOfAll);
    return Run("INSERT INTO tactus_records VALUES ($1, $2, $3) "
               "ON CONFLICT (kind, key) DO UPDATE SET value = EXCLUDED.value",
               {KindOf(table), PgBytes(key),
                PgBytes(SealRecord(table, key, value))})
        .status();
  }

  absl::Status Erase(Table table, absl::string_view key) override {
    Note(table, News::kOfAll);
    return Run("DELETE FROM tactus_records WHERE kind = $1 AND key = $2",
               {KindOf(table), PgBytes(key)})
        .status();
  }

  // True if the transaction met another one, whatever its function made of it.
  bool met_another() const { return met_another_; }
  bool wrote() const { return wrote_; }
  // What others want to know.
  News news() const { return news_; }

 private:
  void Note(Table table, News news) {
    wrote_ = true;
    if (table != Table::kBeats) news_ = std::max(news_, news);
  }
  static PgValue KindOf(Table table) {
    return PgInteger(static_cast<int>(table));
  }
  absl::StatusOr<PgRows> Run(const std::string& sql,
                             const std::vector<PgValue>& values) const {
    auto rows = connection_.Run(sql, values);
    if (IsConflict(connection_.sqlstate())) met_another_ = true;
    return rows;
  }

  PgConnection& connection_;
  mutable bool met_another_ = false;
  bool wrote_ = false;
  News news_ = News::kNone;
};

// How one try of a transaction ended.
struct Attempt {
  absl::Status status;
  // Nothing has changed, and another try may do it.
  bool again = false;
  // Whether it has changed something is known to the database alone, by this
  // number of the transaction.
  std::string in_doubt = {};
};

class PostgresCatalog final : public Catalog {
 public:
  explicit PostgresCatalog(std::string address)
      : address_(std::move(address)) {}

  absl::Status Prepare() {
    return WithConnection([](PgConnection& connection) {
      const absl::Status made = Migrate(connection);
      if (!made.ok() && connection.is_good()) {
        connection.Run("ROLLBACK").status().IgnoreError();
      }
      return made;
    });
  }

  absl::Status CheckExisting() const {
    return WithConnection([&](PgConnection& connection) -> absl::Status {
      TACTUS_ASSIGN_OR_RETURN(
          const PgRows found,
          connection.Run("SELECT to_regclass('tactus_catalog')::text"));
      if (found.IsNull(0, 0)) {
        return DataLost(ShownAddress(address_),
                        "the database holds no catalogue of Tactus");
      }
      TACTUS_RETURN_IF_ERROR(CheckVersion(connection));
      TACTUS_ASSIGN_OR_RETURN(
          const PgRows rows,
          connection.Run("SELECT version FROM tactus_catalog"));
      if (rows.Integer(0, 0) >= kPostgresVersion) return absl::OkStatus();
      return DataLost("tactus_catalog",
                      absl::StrCat("has version ", rows.Integer(0, 0),
                                   ", and this program ", kPostgresVersion,
                                   "; start a server of this release once"));
    });
  }

  absl::Status Change(
      absl::FunctionRef<absl::Status(Transaction&)> change) override {
    return Try("BEGIN ISOLATION LEVEL SERIALIZABLE", change);
  }

  absl::Status Look(
      absl::FunctionRef<absl::Status(const Transaction&)> look) const override {
    return Try("BEGIN ISOLATION LEVEL SERIALIZABLE READ ONLY",
               [&](Transaction& transaction) { return look(transaction); });
  }

  absl::Status Check() const override {
    TACTUS_RETURN_IF_ERROR(WithConnection(CheckVersion));
    for (const auto& named : kTables) {
      const Table table = named.first;
      ScanOptions options = {.limit = kRecordsPerCheck};
      while (true) {
        std::vector<CatalogEntry> entries;
        TACTUS_RETURN_IF_ERROR(Look([&](const Transaction& look) {
          auto scanned = look.Scan(table, options);
          if (scanned.ok()) entries = *std::move(scanned);
          return scanned.status();
        }));
        if (static_cast<int>(entries.size()) < kRecordsPerCheck) break;
        options.after = entries.back().key;
      }
    }
    return absl::OkStatus();
  }

 private:
  using Connection = std::unique_ptr<PgConnection>;

  static absl::Status CheckVersion(PgConnection& connection) {
    TACTUS_ASSIGN_OR_RETURN(
        const PgRows rows,
        connection.Run("SELECT version, oldest_version FROM tactus_catalog"));
    if (rows.size() != 1) {
      return DataLost("tactus_catalog", "it does not have one row");
    }
    if (rows.Integer(0, 1) > kPostgresVersion) {
      return DataLost("tactus_catalog",
                      absl::StrCat("has version ", rows.Integer(0, 0),
                                   ", which needs a program of version ",
                                   rows.Integer(0, 1), "; this one has ",
                                   kPostgresVersion));
    }
    return absl::OkStatus();
  }

  static absl::Status Migrate(PgConnection& connection) {
    TACTUS_RETURN_IF_ERROR(connection.Run("BEGIN").status());
    TACTUS_RETURN_IF_ERROR(connection.Run(kSchemaLock).status());
    TACTUS_RETURN_IF_ERROR(
        connection
            .Run("CREATE TABLE IF NOT EXISTS tactus_catalog ("
                 "  one boolean PRIMARY KEY DEFAULT true CHECK (one),"
                 "  version integer NOT NULL,"
                 "  oldest_version integer NOT NULL)")
            .status());
    TACTUS_RETURN_IF_ERROR(
        connection
            .Run("INSERT INTO tactus_catalog VALUES (true, 0, 0) "
                 "ON CONFLICT DO NOTHING")
            .status());
    TACTUS_RETURN_IF_ERROR(CheckVersion(connection));
    TACTUS_ASSIGN_OR_RETURN(
        const PgRows rows,
        connection.Run("SELECT version FROM tactus_catalog"));
    const int64_t version = rows.Integer(0, 0);
    for (int64_t next = version; next < kPostgresVersion; ++next) {
      TACTUS_RETURN_IF_ERROR(
          connection.Run(kPostgresMigrations[next]).status());
    }
    if (version < kPostgresVersion) {
      TACTUS_RETURN_IF_ERROR(
          connection
              .Run(
                  "UPDATE tactus_catalog SET version = $1, oldest_version = $2",
                  {PgInteger(kPostgresVersion),
                   PgInteger(kOldestPostgresVersion)})
              .status());
    }
    return connection.Run("COMMIT").status();
  }

  absl::Status Try(const char* begin,
                   absl::FunctionRef<absl::Status(Transaction&)> change) const {
    const Clock::time_point until =
        Clock::now() + std::chrono::milliseconds(limits::kCatalogChangeMs);
    std::chrono::milliseconds pause(1);
    while (true) {
      TACTUS_ASSIGN_OR_RETURN(Connection connection, Take(until));
      const Attempt attempt = TryOnce(*connection, begin, change);
      Give(std::move(connection));
      if (!attempt.in_doubt.empty()) {
        TACTUS_ASSIGN_OR_RETURN(const bool done,
                                WasCommitted(attempt.in_doubt, until));
        if (done) return absl::OkStatus();
      } else if (!attempt.again) {
        return attempt.status;
      }
      if (Clock::now() + pause > until) {
        return attempt.status.ok()
                   ? CatalogUnavailable(ShownAddress(address_),
                                        "others change the same records")
                   : attempt.status;
      }
      std::this_thread::sleep_for(pause);
      pause = std::min(2 * pause, std::chrono::milliseconds(100));
    }
  }

  static Attempt TryOnce(PgConnection& connection, const char* begin,
                         absl::FunctionRef<absl::Status(Transaction&)> change) {
    if (const absl::Status begun = connection.Run(begin).status();
        !begun.ok()) {
      return {begun, !connection.is_good()};
    }
    PostgresTransaction transaction(connection);
    const absl::Status changed = change(transaction);
    if (!connection.is_good()) {
      return {changed.ok() ? connection.Run("").status() : changed, true};
    }
    if (!changed.ok() || transaction.met_another()) {
      connection.Run("ROLLBACK").status().IgnoreError();
      return {changed, transaction.met_another()};
    }
    std::string number;
    if (transaction.wrote()) {
      const auto told = connection.Run(absl::StrCat(
          "SELECT pg_current_xact_id()::text", Telling(transaction.news())));
      if (!told.ok()) {
        connection.Run("ROLLBACK").status().IgnoreError();
        return {told.status(),
                !connection.is_good() || IsConflict(connection.sqlstate())};
      }
      number = std::string(told->Bytes(0, 0));
    }
    const auto committed = connection.Run("COMMIT");
    if (committed.ok() && committed->command() == "COMMIT") return {};
    if (!connection.is_good()) {
      return {committed.status(), number.empty(), number};
    }
    return {committed.status(), IsConflict(connection.sqlstate())};
  }

  // Whether the transaction of this number has changed the database.
  absl::StatusOr<bool> WasCommitted(const std::string& number,
                                    Clock::time_point until) const {
    while (true) {
      TACTUS_ASSIGN_OR_RETURN(Connection connection, Take(until));
      const auto rows =
          connection->Run("SELECT pg_xact_status($1::xid8)", {PgText(number)});
      Give(std::move(connection));
      std::string status = "in progress";
      if (rows.ok() && !rows->IsNull(0, 0)) {
        status = std::string(rows->Bytes(0, 0));
      }
      if (status == "committed") return true;
      if (status == "aborted") return false;
      if (Clock::now() > until) {
        return CatalogUnavailable(ShownAddress(address_),
                                  "whether the change was made is not known");
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  template <typename Body>
  absl::Status WithConnection(const Body& body) const {
    TACTUS_ASSIGN_OR_RETURN(Connection connection,
                            Take(Clock::now() + std::chrono::milliseconds(
                                                    limits::kCatalogChangeMs)));
    const absl::Status status = body(*connection);
    Give(std::move(connection));
    return status;
  }

  // An idle connection, or a new one.
  absl::StatusOr<Connection> Take(Clock::time_point until) const {
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait_until(lock, until, [&] {
            return !idle_.empty() || open_ < limits::kCatalogConnections;
          })) {
        return CatalogUnavailable(ShownAddress(address_),
                                  "all connections are in use");
      }
      if (!idle_.empty()) {
        Connection connection = std::move(idle_.back());
        idle_.pop_back();
        return connection;
      }
      ++open_;
    }
    auto connection = PgConnection::Open(address_);
    if (!connection.ok()) Give(nullptr);
    return connection;
  }

  // Null, or one that was lost: there may be another one instead.
  void Give(Connection connection) const {
    {
      const std::lock_guard lock(mutex_);
      if (connection != nullptr && connection->is_good()) {
        idle_.push_back(std::move(connection));
      } else {
        --open_;
        // Those that wait may be lost, too.
        open_ -= static_cast<int>(idle_.size());
        idle_.clear();
      }
    }
    changed_.notify_all();
  }

  const std::string address_;
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  mutable std::vector<Connection> idle_;
  // Idle ones too.
  mutable int open_ = 0;
};

}  // namespace

bool IsPostgresAddress(absl::string_view address) {
  return absl::StartsWith(address, "postgresql://") ||
         absl::StartsWith(address, "postgres://");
}

absl::StatusOr<std::unique_ptr<Catalog>> OpenPostgresCatalog(
    const std::string& address) {
  auto catalog = std::make_unique<PostgresCatalog>(address);
  TACTUS_RETURN_IF_ERROR(catalog->Prepare());
  return catalog;
}

absl::StatusOr<std::unique_ptr<Catalog>> OpenExistingPostgresCatalog(
    const std::string& address) {
  auto catalog = std::make_unique<PostgresCatalog>(address);
  TACTUS_RETURN_IF_ERROR(catalog->CheckExisting());
  return catalog;
}

}  // namespace tactus::internal
