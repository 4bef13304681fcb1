#include "tools/console/robot_channels.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/foreign_decoder.h"
#include "tests/tools/console/robot_fixture.h"

namespace tactus::internal::console {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const RobotChannel& ChannelNamed(const std::string& name) {
  return *std::ranges::find(RobotChannels(), name, &RobotChannel::name);
}

TEST(RobotChannelsTest, OtherProgramsDecodeTheMessagesByTheirSchemas) {
  const auto view = RobotView::Of(OpenedRobot("7", "arm").opened());
  ASSERT_TRUE(view.ok()) << view.status();
  const v1::WatchedFrame frame = FrameOf("7", 5).frame();
  const auto text = [&](const std::string& name) {
    const RobotChannel& channel = ChannelNamed(name);
    return ForeignDecoder(channel.schema).Text(channel.encode(*view, frame));
  };
  EXPECT_THAT(text("skin"),
              AllOf(HasSubstr("timestamp { nanos: 50000000 }"),
                    HasSubstr("width: 3 height: 2 encoding: \"32FC1\"")));
  EXPECT_EQ(text("answer"), frame.answer().ShortDebugString());
  EXPECT_THAT(text("contacts"), AllOf(HasSubstr("type: LINE_LIST points"),
                                      HasSubstr("text: \"1: soft\"")));
  // Events are sent as they are.
  const RobotChannel& events = ChannelNamed("events");
  EXPECT_EQ(events.encode, nullptr);
  const v1::WatchedEvent event = EventOf("7", 9).events(0);
  EXPECT_EQ(ForeignDecoder(events.schema).Text(event.SerializeAsString()),
            event.ShortDebugString());
}

TEST(RobotChannelsTest, AFrameWithoutTaxelsIsNoPicture) {
  const auto view = RobotView::Of(OpenedRobot("7", "arm").opened());
  v1::WatchedFrame frame = FrameOf("7", 5).frame();
  frame.mutable_taxels()->resize(4);
  EXPECT_EQ(ChannelNamed("skin").encode(*view, frame), "");
  EXPECT_THAT(ChannelNamed("answer").encode(*view, frame), Not(""));
}

TEST(RobotChannelsTest, ASkinThatCannotBeIsNotShown) {
  v1::StreamUpdate update = OpenedRobot("7", "arm");
  update.mutable_opened()->mutable_started()->mutable_geometry()->set_rows(
      4'000'000'000);
  EXPECT_FALSE(RobotView::Of(update.opened()).ok());
}

TEST(RobotChannelsTest, NamesBecomeLegalTopics) {
  EXPECT_EQ(TopicPart("arm-1_b"), "arm-1_b");
  EXPECT_EQ(TopicPart("left arm/#2"), "left_arm__2");
  EXPECT_EQ(TopicPart("\xc3\xa9\n\"{}"), "______");
  EXPECT_EQ(TopicPart(""), "");
}

}  // namespace
}  // namespace tactus::internal::console
