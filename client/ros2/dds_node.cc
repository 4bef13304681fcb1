#include "client/ros2/dds_node.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/ros2/raw_type.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "dds/dds.h"

namespace tactus::internal::client {
namespace {

// By the standard's ports there is room for no more.
constexpr int kMaxDomain = 232;
// Topics whose types are kept.
constexpr size_t kMaxTopics = 10'000;
constexpr dds_duration_t kWriteLimit = DDS_MSECS(100);

absl::Status DdsError(absl::string_view what, dds_return_t code) {
  return IoError(what, absl::StrCat("DDS says ", dds_strretcode(-code)));
}

bool IsWord(absl::string_view word) {
  return !word.empty() && !absl::ascii_isdigit(word.front()) &&
         std::ranges::all_of(
             word, [](char c) { return absl::ascii_isalnum(c) || c == '_'; });
}

// "/touch/left" as "rt/touch/left".
absl::StatusOr<std::string> DdsTopic(const std::string& topic) {
  const std::vector<std::string> words = absl::StrSplit(topic, '/');
  const bool good =
      words.size() > 1 && words.front().empty() &&
      std::all_of(words.begin() + 1, words.end(),
                  [](const std::string& word) { return IsWord(word); });
  if (!good) {
    return InvalidConfig("topic", Quoted(topic),
                         "a name like /touch or /arm/touch");
  }
  return absl::StrCat("rt", topic);
}

// "std_msgs/msg/String" as "std_msgs::msg::dds_::String_".
absl::StatusOr<std::string> DdsType(const std::string& type) {
  const std::vector<std::string> words = absl::StrSplit(type, '/');
  if (words.size() != 3 || words[1] != "msg" || !IsWord(words[0]) ||
      !IsWord(words[2])) {
    return InvalidConfig("type", Quoted(type),
                         "a name like std_msgs/msg/UInt16MultiArray");
  }
  return absl::StrCat(words[0], "::msg::dds_::", words[2], "_");
}

// The other way around; nothing for a type that is not one of ROS 2.
std::optional<std::string> RosType(absl::string_view type) {
  const std::vector<absl::string_view> words = absl::StrSplit(type, "::");
  if (words.size() != 4 || words[1] != "msg" || words[2] != "dds_" ||
      !absl::EndsWith(words[3], "_")) {
    return std::nullopt;
  }
  return absl::StrCat(words[0], "/msg/",
                      words[3].substr(0, words[3].size() - 1));
}

struct DeleteQos {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};

std::unique_ptr<dds_qos_t, DeleteQos> MakeQos(const DdsQos& from) {
  std::unique_ptr<dds_qos_t, DeleteQos> qos(dds_create_qos());
  dds_qset_reliability(
      qos.get(),
      from.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
      kWriteLimit);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, from.depth);
  dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
  return qos;
}

const char* PolicyName(uint32_t id) {
  switch (id) {
    case DDS_RELIABILITY_QOS_POLICY_ID:
      return "reliability";
    case DDS_DURABILITY_QOS_POLICY_ID:
      return "durability";
    case DDS_DEADLINE_QOS_POLICY_ID:
      return "deadline";
    case DDS_LIVELINESS_QOS_POLICY_ID:
      return "liveliness";
    default:
      return "another policy";
  }
}

class CycloneReader final : public DdsReader {
 public:
  CycloneReader(dds_entity_t topic, dds_entity_t reader)
      : topic_(topic), reader_(reader) {}
  ~CycloneReader() override {
    dds_delete(reader_);
    dds_delete(topic_);
  }

  bool Take(DdsMessage& message) override {
    while (true) {
      void* sample = &message.bytes;
      dds_sample_info_t info;
      if (dds_take(reader_, &sample, &info, 1, 1) <= 0) return false;
      if (!info.valid_data) continue;
      // Publishers may leave it out.
      message.published_ns =
          info.source_timestamp > 0 ? info.source_timestamp : dds_time();
      return true;
    }
  }

  int publishers() override {
    dds_subscription_matched_status_t status;
    if (dds_get_subscription_matched_status(reader_, &status) < 0) return 0;
    return static_cast<int>(status.current_count);
  }

  std::string refused_policy() override {
    dds_requested_incompatible_qos_status_t status;
    if (dds_get_requested_incompatible_qos_status(reader_, &status) < 0 ||
        status.total_count == 0) {
      return "";
    }
    return PolicyName(status.last_policy_id);
  }

 private:
  const dds_entity_t topic_;
  const dds_entity_t reader_;
};

class CycloneWriter final : public DdsWriter {
 public:
  CycloneWriter(std::string name, dds_entity_t topic, dds_entity_t writer)
      : name_(std::move(name)), topic_(topic), writer_(writer) {}
  ~CycloneWriter() override {
    dds_delete(writer_);
    dds_delete(topic_);
  }

  absl::Status Write(absl::string_view bytes) override {
    const dds_return_t code = dds_write(writer_, &bytes);
    if (code == DDS_RETCODE_OK) return absl::OkStatus();
    if (code == DDS_RETCODE_TIMEOUT) {
      return NoResponse(name_, kWriteLimit / DDS_MSECS(1));
    }
    return DdsError(name_, code);
  }

  int subscribers() override {
    dds_publication_matched_status_t status;
    if (dds_get_publication_matched_status(writer_, &status) < 0) return 0;
    return static_cast<int>(status.current_count);
  }

 private:
  const std::string name_;
  const dds_entity_t topic_;
  const dds_entity_t writer_;
};

class CycloneNode final : public DdsNode {
 public:
  CycloneNode(int domain, dds_entity_t participant)
      : domain_(domain),
        participant_(participant),
        waitset_(dds_create_waitset(participant)),
        endpoints_(dds_create_reader(
            participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr)) {
    // A set without readers does not wait.
    Attach(endpoints_);
  }
  ~CycloneNode() override { dds_delete(participant_); }

  absl::StatusOr<std::unique_ptr<DdsReader>> Subscribe(
      const std::string& topic, const std::string& type,
      const DdsQos& qos) override {
    TACTUS_ASSIGN_OR_RETURN(const dds_entity_t made, MakeTopic(topic, type));
    const dds_entity_t reader =
        dds_create_reader(participant_, made, MakeQos(qos).get(), nullptr);
    if (reader < 0) {
      dds_delete(made);
      return DdsError(topic, reader);
    }
    Attach(reader);
    return std::make_unique<CycloneReader>(made, reader);
  }

  absl::StatusOr<std::unique_ptr<DdsWriter>> Advertise(
      const std::string& topic, const std::string& type,
      const DdsQos& qos) override {
    TACTUS_ASSIGN_OR_RETURN(const dds_entity_t made, MakeTopic(topic, type));
    const dds_entity_t writer =
        dds_create_writer(participant_, made, MakeQos(qos).get(), nullptr);
    if (writer < 0) {
      dds_delete(made);
      return DdsError(topic, writer);
    }
    return std::make_unique<CycloneWriter>(topic, made, writer);
  }

  absl::StatusOr<std::string> TypeOf(const std::string& topic) override {
    TACTUS_ASSIGN_OR_RETURN(const std::string name, DdsTopic(topic));
    TakeEndpoints();
    const auto found = types_.find(name);
    return found == types_.end() ? "" : found->second;
  }

  void Wait(std::chrono::milliseconds limit) override {
    dds_waitset_wait(waitset_, nullptr, 0, DDS_MSECS(limit.count()));
    // The next call would return at once.
    TakeEndpoints();
  }

  int domain() const override { return domain_; }

 private:
  absl::StatusOr<dds_entity_t> MakeTopic(const std::string& topic,
                                         const std::string& type) {
    TACTUS_ASSIGN_OR_RETURN(const std::string topic_name, DdsTopic(topic));
    TACTUS_ASSIGN_OR_RETURN(const std::string type_name, DdsType(type));
    ddsi_sertype* raw = MakeRawType(type_name);
    const dds_entity_t made = dds_create_topic_sertype(
        participant_, topic_name.c_str(), &raw, nullptr, nullptr, nullptr);
    if (made < 0) {
      ddsi_sertype_unref(raw);
      return DdsError(topic, made);
    }
    return made;
  }

  void Attach(dds_entity_t reader) {
    dds_set_status_mask(reader, DDS_DATA_AVAILABLE_STATUS);
    dds_waitset_attach(waitset_, reader, 0);
  }

  // Robots have hundreds of publishers, so only news are looked at.
  void TakeEndpoints() {
    void* sample = nullptr;
    dds_sample_info_t info;
    while (dds_take(endpoints_, &sample, &info, 1, 1) > 0) {
      const auto* const endpoint =
          static_cast<const dds_builtintopic_endpoint_t*>(sample);
      if (info.valid_data && types_.size() < kMaxTopics) {
        if (auto type = RosType(endpoint->type_name)) {
          types_[endpoint->topic_name] = *std::move(type);
        }
      }
      dds_return_loan(endpoints_, &sample, 1);
      sample = nullptr;
    }
  }

  const int domain_;
  const dds_entity_t participant_;
  const dds_entity_t waitset_;
  const dds_entity_t endpoints_;
  // By topic, as DDS has it.
  std::map<std::string, std::string> types_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<DdsNode>> DdsNode::Open(
    const DdsNodeOptions& options) {
  int domain = options.domain.value_or(0);
  const char* const variable = std::getenv("ROS_DOMAIN_ID");
  const bool from_variable =
      !options.domain && variable != nullptr && *variable != '\0';
  if ((from_variable && !absl::SimpleAtoi(variable, &domain)) || domain < 0 ||
      domain > kMaxDomain) {
    return InvalidConfig(
        from_variable ? "ROS_DOMAIN_ID" : "domain",
        from_variable ? Quoted(variable) : absl::StrCat(domain),
        absl::StrCat("0 to ", kMaxDomain));
  }
  const dds_entity_t participant =
      dds_create_participant(domain, nullptr, nullptr);
  if (participant < 0) {
    return DdsError(absl::StrCat("domain ", domain), participant);
  }
  return std::make_unique<CycloneNode>(domain, participant);
}

}  // namespace tactus::internal::client
