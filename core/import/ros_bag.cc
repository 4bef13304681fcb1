#include "core/import/ros_bag.h"

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/import/ros_message.h"

namespace tactus::internal {

// A message as its bytes. rosbag fills it through ros::serialization.
struct RosBytes {
  std::string bytes;
};

}  // namespace tactus::internal

namespace ros::message_traits {

// Accepts messages of any type.
template <>
struct MD5Sum<tactus::internal::RosBytes> {
  static const char* value() { return "*"; }
  static const char* value(const tactus::internal::RosBytes&) { return "*"; }
};

}  // namespace ros::message_traits

namespace ros::serialization {

template <>
struct Serializer<tactus::internal::RosBytes> {
  template <typename Stream>
  static void read(Stream& stream, tactus::internal::RosBytes& message) {
    message.bytes.assign(reinterpret_cast<const char*>(stream.getData()),
                         stream.getLength());
  }
};

}  // namespace ros::serialization

namespace tactus::internal {
namespace {

using PoseNumbers = std::array<double, 7>;
constexpr std::array<const char*, 7> kPoseFields = {
    "position.x",    "position.y",    "position.z",   "orientation.x",
    "orientation.y", "orientation.z", "orientation.w"};
constexpr std::array<const char*, 7> kPoseNames = {"x",  "y",  "z", "qx",
                                                   "qy", "qz", "qw"};

class BagReader {
 public:
  BagReader(const std::string& path, const BagTopics& topics)
      : path_(path), topics_(topics) {}

  absl::StatusOr<ArrayFile> Run() {
    // The library reports by exception only.
    try {
      bag_.open(path_, rosbag::bagmode::Read);
      TACTUS_RETURN_IF_ERROR(ReadPoses());
      return ReadFrames();
    } catch (const rosbag::BagUnindexedException&) {
      return TrialFileInvalid(
          path_,
          "has no index: the recording was not finished, or the file "
          "was cut; repair it with rosbag reindex");
    } catch (const std::exception& error) {
      return TrialFileInvalid(path_,
                              absl::StrCat("is no bag of ROS 1, or damaged: ",
                                           Printable(error.what())));
    }
  }

 private:
  // Calls take(seconds, numbers) for each message of a topic.
  template <typename Take>
  absl::Status ForEach(const std::string& topic, const Take& take) {
    rosbag::View view(bag_, rosbag::TopicQuery(topic));
    std::optional<RosMessageType> type;
    std::string definition;
    size_t index = 0;
    for (const rosbag::MessageInstance& message : view) {
      if (!type || message.getMessageDefinition() != definition) {
        definition = message.getMessageDefinition();
        auto parsed = RosMessageType::Parse(definition);
        if (!parsed.ok()) return Complain(topic, parsed.status().message());
        type = *std::move(parsed);
      }
      const auto bytes = message.instantiate<RosBytes>();
      if (bytes == nullptr) return Complain(topic, "cannot be read");
      const auto numbers = type->Read(bytes->bytes);
      const auto at = absl::StrCat("message ", index, ": ");
      if (!numbers.ok()) {
        return Complain(topic, absl::StrCat(at, numbers.status().message()));
      }
      if (const absl::Status status = take(message.getTime().toSec(), *numbers);
          !status.ok()) {
        return Complain(topic, absl::StrCat(at, status.message()));
      }
      ++index;
    }
    if (index > 0) return absl::OkStatus();
    std::string held;
    rosbag::View all(bag_);
    for (const rosbag::ConnectionInfo* connection : all.getConnections()) {
      absl::StrAppend(&held, held.empty() ? "" : ", ",
                      Printable(connection->topic));
    }
    return Complain(topic, absl::StrCat("has no message; the bag holds ",
                                        held.empty() ? "none" : held));
  }

  absl::Status Complain(const std::string& topic, absl::string_view what) {
    return TrialFileInvalid(path_,
                            absl::StrCat("topic ", Quoted(topic), ": ", what));
  }

  static absl::StatusOr<const std::vector<double>*> Find(
      const RosNumbers& numbers, const std::string& field) {
    const auto found = numbers.find(field);
    if (found != numbers.end()) return &found->second;
    std::string held;
    for (const auto& [name, values] : numbers) {
      absl::StrAppend(&held, held.empty() ? "" : ", ", Printable(name));
    }
    return absl::NotFoundError(
        absl::StrCat("field ", Quoted(field),
                     " is not in the message, whose numbers are ", held));
  }

  absl::Status ReadPoses() {
    if (topics_.pose.empty()) return absl::OkStatus();
    return ForEach(
        topics_.pose,
        [&](double seconds, const RosNumbers& numbers) -> absl::Status {
          const std::string prefix =
              numbers.contains("pose.position.x") ? "pose." : "";
          PoseNumbers pose;
          for (size_t i = 0; i < pose.size(); ++i) {
            TACTUS_ASSIGN_OR_RETURN(const auto* value,
                                    Find(numbers, prefix + kPoseFields[i]));
            if (value->size() != 1) {
              return absl::NotFoundError("holds more than one pose");
            }
            pose[i] = value->front();
          }
          poses_.emplace_back(seconds, pose);
          return absl::OkStatus();
        });
  }

  // The load of each taxel.
  absl::StatusOr<std::vector<double>> Loads(const RosNumbers& numbers) const {
    const bool normal = topics_.values == "normal";
    if (!normal && topics_.values != "magnitude") {
      TACTUS_ASSIGN_OR_RETURN(const auto* values,
                              Find(numbers, topics_.values));
      return *values;
    }
    std::vector<double> loads;
    for (const char* axis : {"x", "y", "z"}) {
      TACTUS_ASSIGN_OR_RETURN(const auto* values,
                              Find(numbers, absl::StrCat("values_", axis)));
      const std::vector<double>* normals = values;
      if (normal) {
        TACTUS_ASSIGN_OR_RETURN(normals,
                                Find(numbers, absl::StrCat("normals_", axis)));
      }
      if (loads.empty()) loads.resize(values->size(), 0);
      if (values->size() != loads.size() || normals->size() != loads.size()) {
        return absl::NotFoundError(
            absl::StrCat("values_", axis, " and normals_", axis, " hold ",
                         values->size(), " and ", normals->size(),
                         " numbers; there are ", loads.size(), " taxels"));
      }
      for (size_t i = 0; i < loads.size(); ++i) {
        loads[i] += (*values)[i] * (*normals)[i];
      }
    }
    if (!normal) {
      for (double& load : loads) load = std::sqrt(load);
    }
    return loads;
  }

  absl::StatusOr<ArrayFile> ReadFrames() {
    ArrayFile file;
    size_t taxels = 0;
    size_t frames = 0;
    double begin = 0;
    size_t pose = 0;
    TACTUS_RETURN_IF_ERROR(ForEach(
        topics_.frames,
        [&](double seconds, const RosNumbers& numbers) -> absl::Status {
          TACTUS_ASSIGN_OR_RETURN(const auto loads, Loads(numbers));
          if (frames == 0) {
            begin = seconds;
            taxels = loads.size();
          }
          if (loads.size() != taxels) {
            return absl::NotFoundError(absl::StrCat(
                "has ", loads.size(), " taxels; the first has ", taxels));
          }
          std::vector<double>& row = file.array.f64;
          if (row.size() + loads.size() > limits::kMaxCsvCells) {
            return absl::NotFoundError(
                absl::StrCat("is beyond the ", limits::kMaxCsvCells,
                             " numbers that are read of a file"));
          }
          row.push_back(seconds - begin);
          if (!poses_.empty()) {
            while (pose + 1 < poses_.size() &&
                   poses_[pose + 1].first <= seconds) {
              ++pose;
            }
            row.insert(row.end(), poses_[pose].second.begin(),
                       poses_[pose].second.end());
          }
          row.insert(row.end(), loads.begin(), loads.end());
          ++frames;
          return absl::OkStatus();
        }));
    file.header = {"time"};
    if (!poses_.empty()) {
      file.header.insert(file.header.end(), kPoseNames.begin(),
                         kPoseNames.end());
    }
    for (size_t i = 0; i < taxels; ++i) {
      file.header.push_back(absl::StrCat("taxel ", i));
    }
    file.array.shape = {frames, file.header.size()};
    return file;
  }

  const std::string path_;
  const BagTopics topics_;
  rosbag::Bag bag_;
  std::vector<std::pair<double, PoseNumbers>> poses_;
};

}  // namespace

absl::StatusOr<ArrayFile> ReadBag(const std::string& path,
                                  const BagTopics& topics) {
  return BagReader(path, topics).Run();
}

}  // namespace tactus::internal
