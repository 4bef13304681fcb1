#include <sqlite3.h>

#include <filesystem>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits_bags.h"
#include "core/base/status_macros.h"
#include "core/import/ros2/bag_files.h"

namespace tactus::internal {
namespace {

constexpr int kStepsPerCall = 1'000'000;

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
struct FinalizeStatement {
  void operator()(sqlite3_stmt* statement) const {
    sqlite3_finalize(statement);
  }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, FinalizeStatement>;

absl::string_view BytesAt(sqlite3_stmt* row, int column) {
  const void* const bytes = sqlite3_column_blob(row, column);
  const auto size = static_cast<size_t>(sqlite3_column_bytes(row, column));
  if (bytes == nullptr) return {};
  return {static_cast<const char*>(bytes), size};
}

// The name under which SQLite opens a bag without a trace: by default reading a
// bag puts two files beside it, which a read-only folder refuses. If there is a
// log of a recorder that was killed, its messages matter more.
std::string NameOf(const std::string& path) {
  std::error_code error;
  const auto log_bytes = std::filesystem::file_size(path + "-wal", error);
  const bool has_log = !error && log_bytes > 0;
  std::string name = "file:";
  for (const char letter : path) {
    if (letter == '?' || letter == '#' || letter == '%') {
      absl::StrAppend(&name, "%", absl::Hex(letter));
    } else {
      name += letter;
    }
  }
  return absl::StrCat(name, has_log ? "" : "?immutable=1");
}

class SqliteBag final : public BagFile {
 public:
  explicit SqliteBag(std::string path) : path_(std::move(path)) {}

  absl::Status Open() {
    sqlite3* opened = nullptr;
    const int result = sqlite3_open_v2(
        NameOf(path_).c_str(), &opened,
        SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_URI, nullptr);
    database_.reset(opened);
    if (result != SQLITE_OK) return IoError(path_, "cannot be opened");
    // The file may come from a stranger.
    sqlite3_db_config(opened, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_limit(opened, SQLITE_LIMIT_LENGTH,
                  static_cast<int>(limits::kMaxBagMessageBytes));
    sqlite3_progress_handler(opened, kStepsPerCall, &CountSteps, this);
    TACTUS_RETURN_IF_ERROR(CheckTables());
    TACTUS_RETURN_IF_ERROR(ReadTopics());
    // Rows lie in the order in which they were recorded.
    return Prepare("SELECT topic_id, timestamp, data FROM messages ORDER BY id",
                   &messages_);
  }

  absl::StatusOr<bool> Next(BagMessage* message,
                            const BagTopic** topic) override {
    TACTUS_ASSIGN_OR_RETURN(const bool more, Step(messages_.get()));
    if (!more) return false;
    const int64_t id = sqlite3_column_int64(messages_.get(), 0);
    const auto found = topics_.find(id);
    if (found == topics_.end()) {
      return TrialFileInvalid(
          path_, absl::StrCat("has a message of the unknown topic ", id));
    }
    message->time_ns = sqlite3_column_int64(messages_.get(), 1);
    message->data = BytesAt(messages_.get(), 2);
    *topic = &found->second;
    return true;
  }

  std::vector<BagTopic> AllTopics() const override {
    std::vector<BagTopic> topics;
    for (const auto& [id, topic] : topics_) topics.push_back(topic);
    return topics;
  }
  std::set<std::string> Compressions() const override { return {}; }
  std::string CutOff() const override { return ""; }

 private:
  static int CountSteps(void* self) {
    auto* const bag = static_cast<SqliteBag*>(self);
    bag->steps_ += kStepsPerCall;
    return bag->steps_ > limits::kMaxBagQuerySteps ? 1 : 0;
  }

  absl::Status Invalid(absl::string_view message) const {
    return TrialFileInvalid(path_, message);
  }

  absl::Status Prepare(const std::string& query, Statement* statement) {
    sqlite3_stmt* prepared = nullptr;
    const int result = sqlite3_prepare_v2(database_.get(), query.c_str(), -1,
                                          &prepared, nullptr);
    statement->reset(prepared);
    if (result == SQLITE_OK) return absl::OkStatus();
    return Invalid(
        absl::StrCat("is no bag of ROS 2: ", sqlite3_errmsg(database_.get())));
  }

  absl::StatusOr<bool> Step(sqlite3_stmt* statement) {
    const int result = sqlite3_step(statement);
    if (result == SQLITE_ROW) return true;
    if (result == SQLITE_DONE) return false;
    if (result == SQLITE_CORRUPT || result == SQLITE_NOTADB) {
      return DataLost(path_, sqlite3_errmsg(database_.get()));
    }
    if (result == SQLITE_INTERRUPT) return Invalid("takes too long to read");
    return Invalid(sqlite3_errmsg(database_.get()));
  }

  // Views could be anything, and could go on forever.
  absl::Status CheckTables() {
    Statement tables;
    TACTUS_RETURN_IF_ERROR(Prepare(
        "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND "
        "name IN ('topics', 'messages') AND sql NOT LIKE 'CREATE VIRTUAL%'",
        &tables));
    TACTUS_ASSIGN_OR_RETURN(const bool more, Step(tables.get()));
    if (more && sqlite3_column_int(tables.get(), 0) == 2) {
      return absl::OkStatus();
    }
    return Invalid("is no bag of ROS 2: it needs the tables topics, messages");
  }

  absl::Status ReadTopics() {
    TACTUS_ASSIGN_OR_RETURN(const auto definitions, ReadDefinitions());
    Statement topics;
    TACTUS_RETURN_IF_ERROR(Prepare(
        "SELECT id, name, type, serialization_format FROM topics", &topics));
    while (true) {
      TACTUS_ASSIGN_OR_RETURN(const bool more, Step(topics.get()));
      if (!more) return absl::OkStatus();
      if (topics_.size() >= limits::kMaxBagTopics) {
        return Invalid(
            absl::StrCat("has more than ", limits::kMaxBagTopics, " topics"));
      }
      BagTopic& topic = topics_[sqlite3_column_int64(topics.get(), 0)];
      topic.name = std::string(BytesAt(topics.get(), 1));
      topic.type = std::string(BytesAt(topics.get(), 2));
      topic.encoding = std::string(BytesAt(topics.get(), 3));
      const auto found = definitions.find(topic.type);
      if (found != definitions.end()) topic.definition = found->second;
    }
  }

  // By type. Bags before Iron have none.
  absl::StatusOr<std::map<std::string, std::string>> ReadDefinitions() {
    std::map<std::string, std::string> definitions;
    Statement rows;
    const absl::Status status = Prepare(
        absl::StrCat("SELECT topic_type, encoded_message_definition FROM "
                     "message_definitions WHERE encoding = 'ros2msg' LIMIT ",
                     limits::kMaxBagTopics),
        &rows);
    if (!status.ok()) return definitions;
    while (true) {
      TACTUS_ASSIGN_OR_RETURN(const bool more, Step(rows.get()));
      if (!more) return definitions;
      const absl::string_view text = BytesAt(rows.get(), 1);
      if (text.size() > limits::kMaxBagDefinitionBytes) continue;
      definitions[std::string(BytesAt(rows.get(), 0))] = std::string(text);
    }
  }

  const std::string path_;
  Database database_;
  int64_t steps_ = 0;
  std::map<int64_t, BagTopic> topics_;
  Statement messages_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<BagFile>> OpenSqliteBag(
    const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return IoError(path, "cannot be read");
  }
  auto bag = std::make_unique<SqliteBag>(path);
  TACTUS_RETURN_IF_ERROR(bag->Open());
  return bag;
}

}  // namespace tactus::internal
