#include "core/import/ros2/read_ros2_bag.h"

#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/import/ros2/ros2_bag.h"
#include "core/import/ros2/ros2_taxels.h"
#include "core/import/ros2/ros2_type.h"

namespace tactus::internal {
namespace {

struct Stamped {
  int64_t time_ns = 0;
  std::vector<double> numbers;
};

// The wanted messages of one topic.
class TopicReader {
 public:
  TopicReader(std::string path, std::string topic)
      : path_(std::move(path)), topic_(std::move(topic)) {}

  const std::string& topic() const { return topic_; }
  const std::string& type() const { return type_; }
  size_t messages() const { return messages_; }

  absl::StatusOr<Ros2Message> Read(const BagTopic& topic,
                                   absl::string_view bytes) {
    ++messages_;
    if (!decoder_) {
      if (topic.encoding != "cdr") {
        return Fault(absl::StrCat("is encoded as ", Quoted(topic.encoding),
                                  "; cdr is read"));
      }
      auto decoder = Ros2Type::Parse(topic.type, topic.definition);
      if (!decoder.ok()) return Fault(decoder.status().message());
      decoder_ = *std::move(decoder);
      type_ = topic.type;
    }
    if (topic.type != type_) {
      return Fault(absl::StrCat("has the types ", Quoted(type_), " and ",
                                Quoted(topic.type)));
    }
    auto message = decoder_->Read(bytes);
    if (!message.ok()) return Fault(message.status().message());
    return message;
  }

  absl::Status Fault(absl::string_view fault) const {
    const std::string where =
        messages_ == 0 ? "" : absl::StrCat("message ", messages_, ": ");
    return TrialFileInvalid(
        path_, absl::StrCat("topic ", Quoted(topic_), ": ", where, fault));
  }

 private:
  const std::string path_;
  const std::string topic_;
  std::string type_;
  std::optional<Ros2Type> decoder_;
  size_t messages_ = 0;
};

std::string TopicNames(const Ros2Bag& bag) {
  std::vector<std::string> names;
  for (const BagTopic& topic : bag.topics()) names.push_back(topic.name);
  return Printable(absl::StrJoin(names, ", ")).substr(0, 500);
}

constexpr const char* kPoseNames[] = {"x", "y", "z", "qx", "qy", "qz", "qw"};

ArrayFile MakeArray(const std::vector<Stamped>& frames,
                    const std::vector<Stamped>& poses) {
  ArrayFile file;
  file.header = {"time"};
  if (!poses.empty()) {
    file.header.insert(file.header.end(), std::begin(kPoseNames),
                       std::end(kPoseNames));
  }
  for (size_t i = 0; i < frames.front().numbers.size(); ++i) {
    file.header.push_back(absl::StrCat("taxel ", i));
  }
  file.array.shape = {frames.size(), file.header.size()};
  file.found = "times are those at which the recorder received the messages";
  size_t pose = 0;
  std::vector<double>& out = file.array.f64;
  for (const Stamped& frame : frames) {
    out.push_back(SecondsBetween(frames.front().time_ns, frame.time_ns));
    if (!poses.empty()) {
      while (pose + 1 < poses.size() &&
             poses[pose + 1].time_ns <= frame.time_ns) {
        ++pose;
      }
      out.insert(out.end(), poses[pose].numbers.begin(),
                 poses[pose].numbers.end());
    }
    out.insert(out.end(), frame.numbers.begin(), frame.numbers.end());
  }
  return file;
}

}  // namespace

absl::StatusOr<ArrayFile> ReadRos2Bag(const std::string& path,
                                      const Ros2Topics& topics) {
  TACTUS_ASSIGN_OR_RETURN(const auto bag, Ros2Bag::Open(path));
  TopicReader frame_reader(path, topics.frames);
  TopicReader pose_reader(path, topics.pose);
  std::vector<Stamped> frames;
  std::vector<Stamped> poses;
  size_t numbers = 0;
  while (true) {
    TACTUS_ASSIGN_OR_RETURN(const BagMessage* const message, bag->Next());
    if (message == nullptr) break;
    const BagTopic& topic = bag->topics()[message->topic];
    if (topic.name == topics.frames) {
      TACTUS_ASSIGN_OR_RETURN(const Ros2Message read,
                              frame_reader.Read(topic, message->data));
      auto taxels = TaxelsOf(topic.type, read, topics.values);
      if (!taxels.ok()) return frame_reader.Fault(taxels.status().message());
      const size_t size = taxels->numbers.size();
      if (size == 0) return frame_reader.Fault("has no numbers");
      if (!frames.empty() && size != frames.front().numbers.size()) {
        return frame_reader.Fault(
            absl::StrCat("has ", size, " numbers; the first message has ",
                         frames.front().numbers.size()));
      }
      numbers += size + 8;
      if (numbers > limits::kMaxCsvCells) {
        return frame_reader.Fault(
            absl::StrCat("is beyond the ", limits::kMaxCsvCells,
                         " numbers that are read of a bag"));
      }
      frames.push_back({message->time_ns, std::move(taxels->numbers)});
    } else if (!topics.pose.empty() && topic.name == topics.pose) {
      TACTUS_ASSIGN_OR_RETURN(const Ros2Message read,
                              pose_reader.Read(topic, message->data));
      auto pose = PoseNumbersOf(read);
      if (!pose.ok()) return pose_reader.Fault(pose.status().message());
      numbers += 8;
      if (numbers > limits::kMaxCsvCells) {
        return pose_reader.Fault(
            absl::StrCat("is beyond the ", limits::kMaxCsvCells,
                         " numbers that are read of a bag"));
      }
      poses.push_back({message->time_ns, *std::move(pose)});
    }
  }
  for (const TopicReader* reader : {&frame_reader, &pose_reader}) {
    if (reader->messages() > 0 ||
        (reader == &pose_reader && topics.pose.empty())) {
      continue;
    }
    return reader->Fault(
        absl::StrCat("has no message; the bag holds ", TopicNames(*bag)));
  }
  return MakeArray(frames, poses);
}

}  // namespace tactus::internal
