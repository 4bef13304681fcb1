// File: pg_connection.h
//
// PgConnection: one connection to PostgreSQL, by libpq. No call waits longer
// than it was told to, also if the database hangs, and a connection that was
// lost stays lost: libpqxx does otherwise in both.
//
//   TACTUS_ASSIGN_OR_RETURN(auto connection, PgConnection::Open(address));
//   TACTUS_ASSIGN_OR_RETURN(
//       const PgRows rows,
//       connection->Run("SELECT value FROM t WHERE key = $1", {PgBytes(key)}));
//   if (rows.size() > 0) return std::string(rows.Bytes(0, 0));
//
// Errors: CATALOG_UNAVAILABLE if there is no answer, after which is_good() is
// false; STORAGE_FULL; IO for what the database refuses, after which sqlstate()
// says why. Not thread-safe.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

struct pg_conn;
struct pg_result;

namespace tactus::internal {

// A parameter of a statement.
struct PgValue {
  uint32_t type;
  std::string bytes;
  bool binary;
};
PgValue PgBytes(absl::string_view bytes);
PgValue PgInteger(int64_t number);
PgValue PgText(absl::string_view text);

// What a statement returned. Views are valid as long as it lives.
class PgRows {
 public:
  explicit PgRows(pg_result* result);

  int size() const;
  // What a column of bytea or text holds.
  absl::string_view Bytes(int row, int column) const;
  // What a column of smallint, integer or bigint holds.
  int64_t Integer(int row, int column) const;
  bool IsNull(int row, int column) const;
  // The words for what was done, like "COMMIT".
  absl::string_view command() const;

 private:
  std::shared_ptr<pg_result> result_;
};

class PgConnection {
 public:
  // `address`: postgresql://user@host:port/database, with whatever else libpq
  // takes. A password is better in PGPASSFILE.
  static absl::StatusOr<std::unique_ptr<PgConnection>> Open(
      const std::string& address);
  ~PgConnection();

  PgConnection(const PgConnection&) = delete;
  PgConnection& operator=(const PgConnection&) = delete;

  absl::StatusOr<PgRows> Run(const std::string& sql,
                             const std::vector<PgValue>& values = {});
  // The five characters of the last refusal; empty if the last statement was
  // not refused.
  const std::string& sqlstate() const { return sqlstate_; }
  bool is_good() const { return good_; }

  // Waits for a notification. Returns the payloads of all that came; none if
  // none came within `patience`. `wake`: a descriptor that ends the wait when
  // it can be read.
  absl::StatusOr<std::vector<std::string>> WaitForNotices(
      std::chrono::milliseconds patience, int wake);

 private:
  using Time = std::chrono::steady_clock::time_point;

  PgConnection(pg_conn* connection, std::string shown);
  absl::Status Connect(Time until);
  absl::Status Wait(bool for_writing, Time until);
  absl::StatusOr<PgRows> Refused(pg_result* result);
  absl::Status Lost(absl::string_view why);

  pg_conn* const connection_;
  const std::string shown_;
  std::string sqlstate_;
  bool good_ = true;
};

// The address without a password, for people.
std::string ShownAddress(const std::string& address);

}  // namespace tactus::internal
