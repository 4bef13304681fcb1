// Any bytes as a message of ROS 2 of any type, and as a bag in MCAP or SQLite,
// listed and read. Its corpus are the bags of tests/golden/bags.
#include "core/import/ros2/bag_summary.h"
#include "core/import/ros2/read_ros2_bag.h"
#include "core/import/ros2/ros2_taxels.h"
#include "core/import/ros2/ros2_type.h"
#include "tests/fuzz/damaged.h"

namespace {

using namespace tactus::internal;

void ReadMessage(FuzzedDataProvider& data) {
  constexpr const char* kTypes[] = {
      "std_msgs/msg/Float32MultiArray", "std_msgs/msg/UInt16MultiArray",
      "sensor_msgs/msg/Image",          "sensor_msgs/msg/MagneticField",
      "tactile_msgs/msg/TactileState",  "geometry_msgs/msg/PoseStamped"};
  const std::string name = data.PickValueInArray(kTypes);
  const std::string definition =
      data.ConsumeBool() ? data.ConsumeRandomLengthString(300) : "";
  const auto type = Ros2Type::Parse(name, definition);
  fuzz::RequireReason(type.status());
  if (!type.ok()) return;
  const std::string header("\0\1\0\0", 4);
  const auto message =
      type->Read(header + data.ConsumeRemainingBytesAsString());
  fuzz::RequireReason(message.status());
  if (!message.ok()) return;
  const auto taxels = TaxelsOf(name, *message, "");
  fuzz::RequireReason(taxels.status());
  if (taxels.ok()) {
    size_t product = 1;
    for (const size_t size : taxels->shape) product *= size;
    REQUIRE(product == taxels->numbers.size());
  }
  fuzz::RequireReason(PoseNumbersOf(*message).status());
}

void ReadBag(const std::string& name, const std::string& bytes) {
  const std::string path = fuzz::Write(name, bytes);
  const auto summary = SummarizeBag(path);
  fuzz::RequireReason(summary.status());
  if (!summary.ok()) return;
  uint64_t messages = 0;
  for (const BagTopicSummary& each : summary->topics) {
    messages += each.messages;
    REQUIRE(each.shape.empty() || each.unread.empty());
  }
  REQUIRE(messages == summary->messages);
  SkinToStartFrom(*summary);
  if (summary->topics.empty()) return;
  const auto file =
      ReadRos2Bag(path, {.frames = summary->topics.front().topic.name});
  fuzz::RequireReason(file.status());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  static const auto* const mcap = new std::vector<std::string>{
      fuzz::Golden("bags/talker.mcap"), fuzz::Golden("bags/cdr_test_0.mcap")};
  static const auto* const sqlite =
      new std::vector<std::string>{fuzz::Golden("bags/talker_db3/talker.db3")};
  if (size == 0) {
    // The good files are good.
    for (const std::string& file : *mcap) {
      REQUIRE(SummarizeBag(fuzz::Write("a.mcap", file)).ok());
    }
    REQUIRE(SummarizeBag(fuzz::Write("a.db3", sqlite->front())).ok());
    return 0;
  }
  FuzzedDataProvider data(bytes, size);
  const int part = data.ConsumeIntegralInRange(0, 5);
  if (part == 0) {
    ReadBag("a.mcap", fuzz::Damaged(*mcap, data));
  } else if (part == 1) {
    ReadBag("a.db3", fuzz::Damaged(*sqlite, data));
  } else {
    ReadMessage(data);
  }
  return 0;
}
