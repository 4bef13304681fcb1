// Two participants of Cyclone DDS; tests/tools/ros2 has other peers.
#include "client/ros2/dds_node.h"

#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>

#include "absl/strings/str_cat.h"
#include "core/base/limits_bags.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

constexpr char kTextType[] = "std_msgs/msg/String";

std::unique_ptr<DdsNode> Open(int place) {
  setenv("CYCLONEDDS_URI",
         "<CycloneDDS><Domain><General><Interfaces><NetworkInterface "
         "name=\"lo\" multicast=\"false\"/></Interfaces><AllowMulticast>false"
         "</AllowMulticast></General><Discovery><Peers><Peer "
         "address=\"127.0.0.1\"/></Peers><ParticipantIndex>auto"
         "</ParticipantIndex></Discovery></Domain></CycloneDDS>",
         1);
  auto node = DdsNode::Open({.domain = 1 + (getpid() * 4 + place) % 200});
  EXPECT_TRUE(node.ok()) << node.status();
  return *std::move(node);
}

std::string Unique(const std::string& name) {
  return absl::StrCat(name, "_", getpid());
}

template <typename Condition>
bool Becomes(DdsNode& node, const Condition& condition) {
  for (int i = 0; i < 1'000; ++i) {
    if (condition()) return true;
    node.Wait(milliseconds(10));
  }
  return false;
}

// Message `number`, which takes many packets.
std::string Message(int number, size_t size) {
  std::string bytes("\0\1\0\0", 4);
  for (size_t i = 0; i < size; ++i) {
    bytes += static_cast<char>((i * i + static_cast<size_t>(number)) % 251);
  }
  return bytes;
}

TEST(DdsNodeTest, MessagesOfAnySizeArriveAsTheyWere) {
  const auto node = Open(0);
  const auto other = Open(0);
  const std::string topic = Unique("/any/size");
  auto writer = other->Advertise(topic, kTextType, {.depth = 100});
  ASSERT_TRUE(writer.ok()) << writer.status();
  EXPECT_TRUE(
      Becomes(*node, [&] { return *node->TypeOf(topic) == kTextType; }));
  auto reader = node->Subscribe(topic, kTextType, {.depth = 100});
  ASSERT_TRUE(reader.ok()) << reader.status();
  ASSERT_TRUE(Becomes(*node, [&] {
    return (*reader)->publishers() == 1 && (*writer)->subscribers() == 1;
  }));
  const size_t sizes[] = {0, 1, 2, 3, 4, 5, 1'000, 70'001, 300'002};
  for (const size_t size : sizes) {
    ASSERT_TRUE((*writer)->Write(Message(7, size)).ok());
  }
  for (const size_t size : sizes) {
    DdsMessage message;
    ASSERT_TRUE(Becomes(*node, [&] { return (*reader)->Take(message); }));
    EXPECT_EQ(message.bytes, Message(7, size)) << size;
    EXPECT_GT(message.published_ns, 0);
  }
  EXPECT_FALSE((*writer)->Write("abc").ok());
  const std::string too_large(limits::kMaxBagMessageBytes + 1, '\0');
  EXPECT_FALSE((*writer)->Write(too_large).ok());
  EXPECT_EQ((*reader)->refused_policy(), "");
}

TEST(DdsNodeTest, TheNewestMessagesAreKept) {
  const auto node = Open(1);
  const std::string topic = Unique("/newest");
  auto reader = node->Subscribe(topic, kTextType, {.depth = 2});
  auto writer = node->Advertise(topic, kTextType, {.depth = 10});
  ASSERT_TRUE(reader.ok() && writer.ok());
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE((*writer)->Write(Message(i, 10)).ok());
  }
  DdsMessage message;
  ASSERT_TRUE(Becomes(*node, [&] { return (*reader)->Take(message); }));
  EXPECT_EQ(message.bytes, Message(3, 10));
  EXPECT_TRUE((*reader)->Take(message));
  EXPECT_EQ(message.bytes, Message(4, 10));
  EXPECT_FALSE((*reader)->Take(message));
}

TEST(DdsNodeTest, APublisherOfLessIsNamed) {
  const auto node = Open(2);
  const std::string topic = Unique("/less");
  auto writer = node->Advertise(topic, kTextType, SensorQos());
  auto reader = node->Subscribe(topic, kTextType, {.reliable = true});
  ASSERT_TRUE(reader.ok() && writer.ok());
  EXPECT_TRUE(Becomes(
      *node, [&] { return (*reader)->refused_policy() == "reliability"; }));
  EXPECT_EQ((*reader)->publishers(), 0);
}

double CpuSeconds() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec) /
             1e6;
}

// The waits of a node that hears nothing, and that of one whose publishers are
// known, take no time of a processor.
TEST(DdsNodeTest, WaitingCostsNothing) {
  const auto node = Open(3);
  const std::string topic = Unique("/quiet");
  for (int i = 0; i < 2; ++i) {
    const double before = CpuSeconds();
    for (int wait = 0; wait < 10; ++wait) node->Wait(milliseconds(50));
    EXPECT_LT(CpuSeconds() - before, 0.25);
    const auto writer = node->Advertise(topic, kTextType, {});
    const auto reader = node->Subscribe(topic, kTextType, {});
    ASSERT_TRUE(writer.ok() && reader.ok());
  }
}

TEST(DdsNodeTest, NamesThatAreNoneAreRefused) {
  const auto node = Open(0);
  for (const char* const topic : {"touch", "/", "/a b", "/1a", "/a//b", ""}) {
    EXPECT_THAT(node->TypeOf(topic).status().message(), HasSubstr("topic"))
        << topic;
  }
  for (const char* const type :
       {"String", "std_msgs/String", "std_msgs/srv/String", "a/msg/b c"}) {
    EXPECT_THAT(node->Advertise("/a", type, {}).status().message(),
                HasSubstr("type"))
        << type;
  }
  EXPECT_FALSE(DdsNode::Open({.domain = 233}).ok());
  setenv("ROS_DOMAIN_ID", "many", 1);
  EXPECT_THAT(DdsNode::Open({}).status().message(), HasSubstr("ROS_DOMAIN_ID"));
  unsetenv("ROS_DOMAIN_ID");
}

}  // namespace
}  // namespace tactus::internal::client
