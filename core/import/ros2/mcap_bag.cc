#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/files/mcap/mcap_reader.h"
#include "core/import/ros2/bag_files.h"

namespace tactus::internal {
namespace {

class McapBag final : public BagFile {
 public:
  McapBag(std::string path, std::unique_ptr<McapReader> reader)
      : path_(std::move(path)), reader_(std::move(reader)) {}

  absl::StatusOr<bool> Next(BagMessage* message,
                            const BagTopic** topic) override {
    McapRead read = McapRead::kMetadata;
    while (read == McapRead::kMetadata) {
      TACTUS_ASSIGN_OR_RETURN(read, reader_->Next());
    }
    if (read == McapRead::kEnd) return false;
    const McapMessage& found = reader_->message();
    const auto [place, added] = topics_.try_emplace(found.channel);
    if (added) place->second = TopicOf(*found.channel, found.schema);
    message->time_ns = static_cast<int64_t>(found.log_time);
    message->data = found.data;
    *topic = &place->second;
    return true;
  }

  std::vector<BagTopic> AllTopics() const override {
    std::vector<BagTopic> topics;
    for (const auto& [id, channel] : reader_->channels()) {
      const auto schema = reader_->schemas().find(channel.schema);
      topics.push_back(TopicOf(channel, schema == reader_->schemas().end()
                                            ? nullptr
                                            : &schema->second));
    }
    return topics;
  }

  std::set<std::string> Compressions() const override {
    return reader_->compressions();
  }

  std::string CutOff() const override {
    if (reader_->complete()) return "";
    if (reader_->complete_bytes() == reader_->file_bytes()) {
      return absl::StrCat(path_,
                          ": has no end; its recorder did not finish it");
    }
    return absl::StrCat(path_, ": was cut off: ", reader_->complete_bytes(),
                        " of its ", reader_->file_bytes(), " bytes are read");
  }

 private:
  static BagTopic TopicOf(const McapChannel& channel,
                          const McapSchema* schema) {
    BagTopic topic = {.name = channel.topic,
                      .type = "",
                      .encoding = channel.message_encoding,
                      .definition = ""};
    if (schema == nullptr) return topic;
    topic.type = schema->name;
    // Other languages are read by a built-in type, if there is one.
    if (schema->encoding == "ros2msg") topic.definition = schema->data;
    return topic;
  }

  const std::string path_;
  const std::unique_ptr<McapReader> reader_;
  std::map<const McapChannel*, BagTopic> topics_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<BagFile>> OpenMcapBag(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(auto reader, McapReader::Open(path));
  return std::make_unique<McapBag>(path, std::move(reader));
}

}  // namespace tactus::internal
