// File: bag_samples.h
//
// Bags of ROS 2 made for tests: messages encoded by hand, as the CDR of DDS
// says, and files with them. Not what rosbag2 wrote; such files are in
// tests/golden/bags.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "core/files/mcap/mcap_writer.h"
#include "gtest/gtest.h"

namespace tactus::internal {

// A message in the making, little-endian.
class CdrText {
 public:
  template <typename Value>
  CdrText& Put(Value value) {
    while (bytes_.size() % sizeof(Value) != 0) bytes_.push_back('\0');
    const char* const begin = reinterpret_cast<const char*>(&value);
    bytes_.append(begin, sizeof(Value));
    return *this;
  }
  CdrText& PutText(const std::string& text) {
    Put(static_cast<uint32_t>(text.size() + 1));
    bytes_ += text;
    bytes_.push_back('\0');
    return *this;
  }
  template <typename Value>
  CdrText& PutList(const std::vector<Value>& values) {
    Put(static_cast<uint32_t>(values.size()));
    for (const Value value : values) Put(value);
    return *this;
  }
  CdrText& PutHeader() {
    return Put(int32_t{7}).Put(uint32_t{8}).PutText("skin");
  }
  std::string Done() const { return std::string("\0\1\0\0", 4) + bytes_; }

 private:
  std::string bytes_;
};

// A std_msgs/*MultiArray with the sizes of its layout; none: no layout.
template <typename Value>
std::string ArrayMessage(const std::vector<uint32_t>& sizes,
                         const std::vector<Value>& data) {
  CdrText text;
  text.Put(static_cast<uint32_t>(sizes.size()));
  for (const uint32_t size : sizes) {
    text.PutText("d").Put(size).Put(uint32_t{0});
  }
  text.Put(uint32_t{0});
  return text.PutList(data).Done();
}

struct SampleMessage {
  int64_t time_ns = 0;
  std::string bytes;
};

struct SampleTopic {
  std::string name;
  std::string type;
  std::vector<SampleMessage> messages;
  std::string definition = {};
};

// Without its summary if `finish` is false, as a recorder that was killed
// leaves it.
inline void WriteSampleBag(const std::string& path,
                           const std::vector<SampleTopic>& topics,
                           bool finish = true) {
  const auto writer =
      *McapWriter::Create(path, {.library = "a test", .sync = false});
  for (const SampleTopic& topic : topics) {
    const uint16_t channel = writer->AddChannel(
        {writer->AddSchema({topic.type, "ros2msg", topic.definition}),
         topic.name,
         "cdr",
         {}});
    for (const SampleMessage& message : topic.messages) {
      ASSERT_TRUE(writer->Write(channel, message.time_ns, message.bytes).ok());
    }
  }
  ASSERT_TRUE(finish ? writer->Finish().ok() : writer->Flush().ok());
}

// Frames of 2 x 3 taxels at 100 Hz: 20 idle ones, then a touch of ten.
inline SampleTopic TouchTopic(const std::string& name) {
  SampleTopic topic = {
      .name = name, .type = "std_msgs/msg/Float32MultiArray", .messages = {}};
  for (int i = 0; i < 40; ++i) {
    std::vector<float> taxels(6, 0.125F);
    if (i >= 20 && i < 30) taxels[4] = 50 + static_cast<float>(i);
    topic.messages.push_back(
        {1'000'000'000'000 + 10'000'000L * i, ArrayMessage({2, 3}, taxels)});
  }
  return topic;
}

}  // namespace tactus::internal
