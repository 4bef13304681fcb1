#include "client/ros2/skin_topic.h"

#include "core/import/recorded_frames.h"
#include "core/import/ros2/read_ros2_bag.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/import/bag_samples.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr char kType[] = "std_msgs/msg/Float32MultiArray";

SkinFile SmallSkin() {
  SkinFile file;
  file.layout = {.name = "small",
                 .rows = 2,
                 .columns = 3,
                 .row_pitch_m = 0.005,
                 .column_pitch_m = 0.005,
                 .taxel_area_m2 = 25e-6,
                 .unit = TaxelUnit::kCounts,
                 .contact_threshold = 4,
                 .onset_threshold = 5};
  file.sample_rate_hz = 100;
  return file;
}

// Frames of the topic as they come one by one.
std::vector<std::vector<float>> LiveFrames(const SkinFile& file,
                                           const SampleTopic& topic) {
  auto skin = SkinTopic::Make(file, topic.type, "");
  EXPECT_TRUE(skin.ok()) << skin.status();
  std::vector<std::vector<float>> frames;
  for (const SampleMessage& message : topic.messages) {
    Frame frame;
    const auto made = skin->Read({message.bytes, message.time_ns}, frame);
    EXPECT_TRUE(made.ok()) << made.status();
    if (!*made) continue;
    EXPECT_EQ(frame.capture_time_ns, message.time_ns);
    frames.push_back(frame.values);
  }
  return frames;
}

// And as a bag of the topic is imported.
std::vector<float> ImportedFrames(const SkinFile& file,
                                  const SampleTopic& topic) {
  const ScratchDir folder;
  WriteSampleBag(folder / "bag.mcap", {topic});
  const auto read = ReadRos2Bag(folder / "bag.mcap", {.frames = topic.name});
  EXPECT_TRUE(read.ok()) << read.status();
  const auto frames = MakeFrames("bag", *read, file, 100);
  EXPECT_TRUE(frames.ok()) << frames.status();
  return frames->taxels.f32;
}

void ExpectTheBitsOfAnImport(const SkinFile& file, size_t idle) {
  const SampleTopic topic = TouchTopic("/touch");
  const auto live = LiveFrames(file, topic);
  const std::vector<float> imported = ImportedFrames(file, topic);
  ASSERT_EQ(live.size(), topic.messages.size() - idle);
  ASSERT_EQ(imported.size(), topic.messages.size() * 6);
  for (size_t t = 0; t < live.size(); ++t) {
    const auto at = imported.begin() + static_cast<ptrdiff_t>((t + idle) * 6);
    EXPECT_EQ(live[t], std::vector<float>(at, at + 6)) << t;
  }
}

TEST(SkinTopicTest, FramesHaveTheBitsOfAnImport) {
  SkinFile file = SmallSkin();
  file.scale = 0.1;
  ExpectTheBitsOfAnImport(file, 0);
  // Another order of the taxels, and numbers that fall when pressed.
  file.cells = {5, 4, 3, 2, 1, 0};
  file.baseline = 90.3;
  file.pressing_lowers = true;
  ExpectTheBitsOfAnImport(file, 0);
}

TEST(SkinTopicTest, TheBaselineComesFromTheFirstFrames) {
  SkinFile file = SmallSkin();
  file.scale = 0.1;
  file.idle_frames = 15;
  file.baseline_from_idle = true;
  ExpectTheBitsOfAnImport(file, 15);
}

TEST(SkinTopicTest, AMessageOfAnotherShapeIsRefused) {
  auto skin = SkinTopic::Make(SmallSkin(), kType, "");
  ASSERT_TRUE(skin.ok());
  Frame frame;
  const auto made = skin->Read({ArrayMessage<float>({}, {1, 2, 3}), 5}, frame);
  EXPECT_THAT(made.status().message(), HasSubstr("3"));
  EXPECT_FALSE(skin->Read({"", 5}, frame).ok());
  EXPECT_FALSE(skin->Read({std::string(3, '\xff'), 5}, frame).ok());
  const std::string good = ArrayMessage<float>({}, {1, 2, 3, 4, 5, 6});
  EXPECT_FALSE(skin->Read({good.substr(0, good.size() - 1), 5}, frame).ok());
  // And the next one is taken.
  EXPECT_TRUE(skin->Read({good, 6}, frame).ok());
  EXPECT_THAT(frame.values, ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(SkinTopicTest, AStampInTheMessageIsTheFramesTime) {
  auto skin = SkinTopic::Make(SmallSkin(), "sensor_msgs/msg/Image", "");
  ASSERT_TRUE(skin.ok());
  CdrText text;
  text.PutHeader().Put(uint32_t{2}).Put(uint32_t{3}).PutText("mono8");
  text.Put(uint8_t{0}).Put(uint32_t{3});
  text.PutList(std::vector<uint8_t>{1, 2, 3, 4, 5, 6});
  Frame frame;
  const auto made = skin->Read({text.Done(), 99}, frame);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ(frame.capture_time_ns, 7'000'000'008);
  EXPECT_THAT(frame.values, ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(SkinTopicTest, ThresholdsOfIdleFramesAreAskedFor) {
  SkinFile file = SmallSkin();
  file.thresholds_from_idle = true;
  EXPECT_THAT(SkinOf(file, false).status().message(),
              HasSubstr("thresholds is \"from idle frames\""));
}

}  // namespace
}  // namespace tactus::internal::client
