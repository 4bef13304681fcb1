// File: ros2_bag.h
//
// Ros2Bag: the messages of a bag of ROS 2 (rosbag2), in the order in which they
// were recorded. A bag is an .mcap or .db3 file, or a folder with some of them,
// which belong together. Needs no ROS, no index and no metadata.yaml, so it
// also reads what a recorder left that was killed.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto bag, Ros2Bag::Open("run1"));
//   while (true) {
//     TACTUS_ASSIGN_OR_RETURN(const BagMessage* message, bag->Next());
//     if (message == nullptr) break;
//     Use(bag->topics()[message->topic].name, message->data);
//   }
//
// Owns the files. Not thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal {

struct BagTopic {
  std::string name;
  // "std_msgs/msg/Float32MultiArray".
  std::string type;
  // "cdr" for all that is decoded.
  std::string encoding;
  // The text of the type's .msg file and of those that it uses; may be empty.
  std::string definition;
};

struct BagMessage {
  // Place in topics().
  size_t topic = 0;
  // When the recorder received the message.
  int64_t time_ns = 0;
  absl::string_view data;
};

// One file of a bag. Next() and facts as those of Ros2Bag.
class BagFile {
 public:
  virtual ~BagFile() = default;
  // True if there was a message; sets it and its topic, which is the same
  // object for all messages of a topic.
  virtual absl::StatusOr<bool> Next(BagMessage* message,
                                    const BagTopic** topic) = 0;
  // After the last message: topics, also those without messages.
  virtual std::vector<BagTopic> AllTopics() const = 0;
  virtual std::set<std::string> Compressions() const = 0;
  // Says where the file was cut off; empty if it is whole.
  virtual std::string CutOff() const = 0;
};

class Ros2Bag {
 public:
  // IO if there is no such file; TRIAL_FILE_INVALID for one that is no bag.
  static absl::StatusOr<std::unique_ptr<Ros2Bag>> Open(const std::string& path);

  Ros2Bag(const Ros2Bag&) = delete;
  Ros2Bag& operator=(const Ros2Bag&) = delete;

  // Null at the end; valid until the next call. TRIAL_FILE_INVALID, DATA_LOST
  // or IO with the file.
  absl::StatusOr<const BagMessage*> Next();

  // Those so far; after the end also those without messages.
  const std::vector<BagTopic>& topics() const { return topics_; }
  // "mcap" or "sqlite3".
  const std::string& storage() const { return storage_; }
  const std::vector<std::string>& files() const { return files_; }
  // After the end: how messages were compressed, and what was cut off.
  const std::set<std::string>& compressions() const { return compressions_; }
  const std::vector<std::string>& cut_off() const { return cut_off_; }

 private:
  Ros2Bag() = default;

  absl::Status OpenFile();
  absl::StatusOr<size_t> PlaceOf(const BagTopic& topic);

  std::string path_;
  std::string storage_;
  std::vector<std::string> files_;
  // The file that is open, and how many were opened.
  std::unique_ptr<BagFile> file_;
  size_t opened_ = 0;
  std::vector<BagTopic> topics_;
  // By name, type and encoding.
  std::map<std::tuple<std::string, std::string, std::string>, size_t> places_;
  // Place of each topic of the file that is open.
  std::map<const BagTopic*, size_t> file_places_;
  std::set<std::string> compressions_;
  std::vector<std::string> cut_off_;
  uint64_t messages_ = 0;
  BagMessage message_;
  std::string decompressed_;
};

// From one time of a message to another.
double SecondsBetween(int64_t first_ns, int64_t last_ns);

// True if `path` is a folder with metadata.yaml, or has .mcap or .db3 files and
// no skin.json; or an .mcap file with the profile "ros2", or a .db3 file.
bool IsRos2Bag(const std::string& path);

// The first bag in `folder`, by its name: a .mcap or .db3 file, or a folder of
// them. Empty if there is none.
std::string FirstBagIn(const std::string& folder);

}  // namespace tactus::internal
