#include "core/postgres/pg_connection.h"

#include <libpq-fe.h>
#include <poll.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits_catalog.h"
#include "core/base/status_macros.h"
#include "core/store/file_system.h"

namespace tactus::internal {
namespace {

using Clock = std::chrono::steady_clock;

constexpr uint32_t kByteaType = 17;
constexpr uint32_t kBigintType = 20;
constexpr uint32_t kTextType = 25;
constexpr char kDiskFull[] = "53100";

// One line.
std::string TextOf(const char* message) {
  std::string text(absl::StripAsciiWhitespace(message));
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.empty() ? "no reason was given" : text;
}

Clock::time_point In(int ms) {
  return Clock::now() + std::chrono::milliseconds(ms);
}

// The rest of the time, for poll.
int LeftMs(Clock::time_point until) {
  const auto left =
      std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
  return static_cast<int>(std::max<int64_t>(left.count(), 0));
}

}  // namespace

PgValue PgBytes(absl::string_view bytes) {
  return {kByteaType, std::string(bytes), true};
}
PgValue PgInteger(int64_t number) {
  return {kBigintType, absl::StrCat(number), false};
}
PgValue PgText(absl::string_view text) {
  return {kTextType, std::string(text), true};
}

PgRows::PgRows(pg_result* result)
    : result_(result, [](pg_result* done) { PQclear(done); }) {}

int PgRows::size() const { return PQntuples(result_.get()); }

absl::string_view PgRows::Bytes(int row, int column) const {
  return {PQgetvalue(result_.get(), row, column),
          static_cast<size_t>(PQgetlength(result_.get(), row, column))};
}

int64_t PgRows::Integer(int row, int column) const {
  // In the network's order, two to eight bytes of two's complement.
  const absl::string_view bytes = Bytes(row, column);
  uint64_t number = !bytes.empty() && (bytes[0] & 0x80) != 0 ? ~uint64_t{0} : 0;
  for (const char byte : bytes) {
    number = number << 8 | static_cast<unsigned char>(byte);
  }
  return std::bit_cast<int64_t>(number);
}

bool PgRows::IsNull(int row, int column) const {
  return PQgetisnull(result_.get(), row, column) != 0;
}

absl::string_view PgRows::command() const { return PQcmdStatus(result_.get()); }

absl::StatusOr<std::unique_ptr<PgConnection>> PgConnection::Open(
    const std::string& address) {
  // What the address itself says comes later and wins.
  const std::string options = absl::StrCat(
      "-c statement_timeout=", limits::kCatalogAnswerMs,
      " -c idle_in_transaction_session_timeout=", limits::kCatalogChangeMs);
  const char* keywords[] = {"application_name", "client_encoding", "options",
                            "dbname", nullptr};
  const char* values[] = {"tactus", "UTF8", options.c_str(), address.c_str(),
                          nullptr};
  std::unique_ptr<PgConnection> connection(new PgConnection(
      PQconnectStartParams(keywords, values, 1), ShownAddress(address)));
  TACTUS_RETURN_IF_ERROR(connection->Connect(In(limits::kCatalogConnectMs)));
  return connection;
}

PgConnection::PgConnection(pg_conn* connection, std::string shown)
    : connection_(connection), shown_(std::move(shown)) {}

PgConnection::~PgConnection() { PQfinish(connection_); }

absl::Status PgConnection::Connect(Time until) {
  if (PQstatus(connection_) == CONNECTION_BAD) {
    return Lost(TextOf(PQerrorMessage(connection_)));
  }
  PostgresPollingStatusType next = PGRES_POLLING_WRITING;
  while (next != PGRES_POLLING_OK) {
    if (next == PGRES_POLLING_FAILED) {
      return Lost(TextOf(PQerrorMessage(connection_)));
    }
    TACTUS_RETURN_IF_ERROR(Wait(next == PGRES_POLLING_WRITING, until));
    next = PQconnectPoll(connection_);
  }
  // Notices say what is not worth a line, such as that a table exists.
  PQsetNoticeProcessor(
      connection_, [](void*, const char*) {}, nullptr);
  if (PQsetnonblocking(connection_, 1) != 0) {
    return Lost(TextOf(PQerrorMessage(connection_)));
  }
  return absl::OkStatus();
}

absl::Status PgConnection::Wait(bool for_writing, Time until) {
  pollfd state = {
      .fd = PQsocket(connection_),
      .events = static_cast<short>(for_writing ? POLLIN | POLLOUT : POLLIN),
      .revents = 0};
  int ready = 0;
  do {
    ready = poll(&state, 1, LeftMs(until));
  } while (ready < 0 && errno == EINTR);
  if (ready > 0) return absl::OkStatus();
  return Lost(ready == 0 ? "it took too long" : "poll failed");
}

absl::Status PgConnection::Lost(absl::string_view why) {
  good_ = false;
  return CatalogUnavailable(shown_, why);
}

absl::StatusOr<PgRows> PgConnection::Refused(pg_result* result) {
  const PgRows owned(result);
  const char* state = PQresultErrorField(result, PG_DIAG_SQLSTATE);
  const std::string text = TextOf(PQresultErrorMessage(result));
  // Without a state the server said nothing: libpq did.
  if (state == nullptr || PQstatus(connection_) == CONNECTION_BAD) {
    return Lost(text);
  }
  sqlstate_ = state;
  if (sqlstate_ == kDiskFull) {
    return StorageFull(shown_, absl::StrCat(text, "; ", kFullDiskAdvice));
  }
  // The server ends connections, refuses them while it starts, and ends
  // statements that take too long.
  if (sqlstate_.starts_with("57") || sqlstate_.starts_with("08")) {
    return Lost(text);
  }
  return IoError(shown_, text);
}

absl::StatusOr<PgRows> PgConnection::Run(const std::string& sql,
                                         const std::vector<PgValue>& values) {
  sqlstate_.clear();
  if (!good_) return CatalogUnavailable(shown_, "the connection was lost");
  // The server's own limit comes first; this one is for a server that hangs.
  const Time until = In(limits::kCatalogAnswerMs + limits::kCatalogConnectMs);
  std::vector<Oid> types;
  std::vector<const char*> bytes;
  std::vector<int> lengths;
  std::vector<int> formats;
  for (const PgValue& value : values) {
    types.push_back(value.type);
    bytes.push_back(value.bytes.data());
    lengths.push_back(static_cast<int>(value.bytes.size()));
    formats.push_back(value.binary ? 1 : 0);
  }
  if (PQsendQueryParams(connection_, sql.c_str(),
                        static_cast<int>(values.size()), types.data(),
                        bytes.data(), lengths.data(), formats.data(), 1) == 0) {
    return Lost(TextOf(PQerrorMessage(connection_)));
  }
  for (int left = PQflush(connection_); left != 0;
       left = PQflush(connection_)) {
    if (left < 0) return Lost(TextOf(PQerrorMessage(connection_)));
    TACTUS_RETURN_IF_ERROR(Wait(/*for_writing=*/true, until));
    if (PQconsumeInput(connection_) == 0) {
      return Lost(TextOf(PQerrorMessage(connection_)));
    }
  }
  PgRows rows(nullptr);
  pg_result* refusal = nullptr;
  while (true) {
    while (PQisBusy(connection_) != 0) {
      absl::Status waited = Wait(/*for_writing=*/false, until);
      if (waited.ok() && PQconsumeInput(connection_) == 0) {
        waited = Lost(TextOf(PQerrorMessage(connection_)));
      }
      if (!waited.ok()) {
        PQclear(refusal);
        return waited;
      }
    }
    pg_result* const result = PQgetResult(connection_);
    if (result == nullptr) break;
    const ExecStatusType status = PQresultStatus(result);
    if (status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK) {
      rows = PgRows(result);
    } else {
      PQclear(refusal);
      refusal = result;
    }
  }
  if (refusal != nullptr) return Refused(refusal);
  return rows;
}

absl::StatusOr<std::vector<std::string>> PgConnection::WaitForNotices(
    std::chrono::milliseconds patience, int wake) {
  if (!good_) return CatalogUnavailable(shown_, "the connection was lost");
  const Time until = Clock::now() + patience;
  while (true) {
    if (PQconsumeInput(connection_) == 0) {
      return Lost(TextOf(PQerrorMessage(connection_)));
    }
    std::vector<std::string> payloads;
    while (PGnotify* notice = PQnotifies(connection_)) {
      payloads.emplace_back(notice->extra);
      PQfreemem(notice);
    }
    if (!payloads.empty()) return payloads;
    pollfd states[] = {
        {.fd = PQsocket(connection_), .events = POLLIN, .revents = 0},
        {.fd = wake, .events = POLLIN, .revents = 0}};
    const int left = LeftMs(until);
    if (left == 0) return payloads;
    if (poll(states, 2, left) < 0 && errno != EINTR) return Lost("poll failed");
    if (states[1].revents != 0) return payloads;
  }
}

std::string ShownAddress(const std::string& address) {
  char* error = nullptr;
  PQconninfoOption* const parts = PQconninfoParse(address.c_str(), &error);
  PQfreemem(error);
  if (parts == nullptr) return "with an address that libpq cannot read";
  std::string host, port, database;
  for (const PQconninfoOption* part = parts; part->keyword != nullptr; ++part) {
    if (part->val == nullptr) continue;
    const absl::string_view keyword = part->keyword;
    if (keyword == "host" || (keyword == "hostaddr" && host.empty())) {
      host = part->val;
    }
    if (keyword == "port") port = absl::StrCat(":", part->val);
    if (keyword == "dbname") database = absl::StrCat("/", part->val);
  }
  PQconninfoFree(parts);
  return absl::StrCat("postgresql://", host, port, database);
}

}  // namespace tactus::internal
