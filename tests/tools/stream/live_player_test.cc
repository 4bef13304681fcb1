// The whole path: simulated contacts, boards on a bus in memory, the iCub's
// driver, and a real tactusd.
#include "tools/stream/live_player.h"

#include "client/drivers/can_skin_driver.h"
#include "client/drivers/icub_skin/icub_skin.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/memory_bus.h"
#include "tests/client/drivers/until_last_touch.h"
#include "tests/support/child_tactusd.h"
#include "tools/fakeskin/sim_touches.h"
#include "tools/stream/trial_player.h"

namespace tactus::internal::client {
namespace {

using testing::ChildTactusd;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr size_t kContacts = 80;

// A forearm of 32 triangles with the shape that the default model knows.
struct FakeArm {
  explicit FakeArm(size_t contacts, double newton_per_count)
      : touches({.seed = 5,
                 .contacts = contacts,
                 .begin_ns = 3'000'000'000,
                 .newton_per_count = newton_per_count}),
        boards(touches.patch().boards, touches.Source()),
        bus(&boards, &clock),
        skin(touches.patch(), {.period_ms = 10, .scale = newton_per_count}),
        driver(&bus, &skin,
               {.pose_at = [this](int64_t time_ns) -> std::optional<Pose> {
                 return touches.PoseAt(time_ns);
               }},
               &clock) {}

  ManualClock clock;
  SimTouches touches;
  IcubBoards boards;
  MemoryBus bus;
  icub::IcubSkin skin;
  CanSkinDriver driver;
};

struct Score {
  int right = 0;
  int felt = 0;

  double accuracy() const { return static_cast<double>(right) / felt; }
};

// The same contacts without boards and bus.
Score SimScore(const std::shared_ptr<grpc::Channel>& channel) {
  SimDriver driver({.seed = 5}, kContacts, {});
  Score score;
  TrialPlayer player(
      channel, &driver, {.batch = 8}, [&](const TrialResult& result) {
        score.felt += result.detected;
        score.right += result.detected && result.answer == result.label;
      });
  const absl::Status status = player.Run();
  EXPECT_TRUE(status.ok()) << status;
  return score;
}

TEST(LivePlayerTest, AFakeSkinsContactsAreClassifiedAsTheSimulators) {
  ChildTactusd server;
  ASSERT_NE(server.port(), 0);
  const auto channel = MakeChannel(server.address());
  // One count is the model's contact threshold. Coarser, and the answers get
  // worse.
  FakeArm arm(kContacts, 0.01);
  UntilLastTouch driver(&arm.driver, &arm.touches, &arm.clock);
  Score score;
  std::vector<std::string> news;
  const LivePlayer* self = nullptr;
  LivePlayer player(
      channel, &driver, {},
      [&](const LiveContact& contact) {
        ++score.felt;
        const std::string label = arm.touches.LabelAt(contact.onset_ns);
        score.right += self->class_names()[contact.answer] == label;
      },
      [&](const std::string& text) { news.push_back(text); });
  self = &player;
  const absl::Status status = player.Run();
  ASSERT_TRUE(status.ok()) << status;
  EXPECT_EQ(player.missing(), 0u);
  EXPECT_EQ(player.statistics().lost, 0u);
  const Score sim = SimScore(channel);
  std::printf(
      "fake skin: %d of %zu contacts felt, accuracy %.3f; sim driver: %d, "
      "%.3f\n",
      score.felt, kContacts, score.accuracy(), sim.felt, sim.accuracy());
  EXPECT_GE(score.felt, sim.felt - 2);
  EXPECT_GE(score.accuracy(), sim.accuracy() - 0.02);
  EXPECT_THAT(news, Contains(HasSubstr("cody-forearm, 16 x 24 at 100 Hz")));
}

// A skin that sends half as many frames as it is configured for.
class AtHalfTheRate : public UntilLastTouch {
 public:
  using UntilLastTouch::UntilLastTouch;

 protected:
  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override {
    auto result = UntilLastTouch::OnRead(frame);
    frame.capture_time_ns *= 2;
    return result;
  }
};

TEST(LivePlayerTest, AnotherRateIsReportedOnce) {
  ChildTactusd server;
  ASSERT_NE(server.port(), 0);
  FakeArm arm(4, 0.01);
  AtHalfTheRate driver(&arm.driver, &arm.touches, &arm.clock);
  std::string news;
  LivePlayer player(
      MakeChannel(server.address()), &driver, {}, [](const LiveContact&) {},
      [&](const std::string& text) { news += text + "\n"; });
  const absl::Status status = player.Run();
  ASSERT_TRUE(status.ok()) << status;
  const std::string words = "those of 50 Hz, but the stream is configured for";
  const size_t first = news.find(words);
  ASSERT_NE(first, std::string::npos) << news;
  EXPECT_EQ(news.find(words, first + 1), std::string::npos) << news;
}

// What a user sees when a board dies and comes back in mid-stream, and when it
// stays dead.
TEST(LivePlayerTest, ABreakIsReportedAndTheStreamGoesOn) {
  ChildTactusd server;
  ASSERT_NE(server.port(), 0);
  FakeArm arm(4, 0.01);
  // Board 2 is without power from 10 s to 14 s.
  arm.bus.copies = [&](const CanFrame&) {
    const int64_t now_ns = arm.clock.NowNs();
    arm.boards.fault(1).dead =
        now_ns > 10'000'000'000 && now_ns < 14'000'000'000;
    return 1;
  };
  UntilLastTouch driver(&arm.driver, &arm.touches, &arm.clock);
  int contacts = 0;
  uint64_t server_missing = 0;
  std::vector<std::string> news;
  LivePlayer player(
      MakeChannel(server.address()), &driver, {},
      [&](const LiveContact& contact) {
        ++contacts;
        server_missing = contact.frames_missing;
      },
      [&](const std::string& text) { news.push_back(text); });
  const absl::Status status = player.Run();
  ASSERT_TRUE(status.ok()) << status;
  EXPECT_GT(contacts, 0);
  EXPECT_GE(player.missing(), 400u);
  EXPECT_EQ(player.missing(), player.statistics().lost);
  // The server knows of all of them.
  EXPECT_EQ(server_missing, player.missing());
  EXPECT_EQ(player.statistics().reconnects, 1u);
  EXPECT_THAT(news, Contains(HasSubstr("the skin sends no frames: board 2")));
  EXPECT_THAT(news, Contains(HasSubstr("skin board 2 does not answer")));
  EXPECT_THAT(news, Contains(HasSubstr("frames come again")));
  // Lost frames are no other rate.
  EXPECT_THAT(news, Not(Contains(HasSubstr("the times of the frames"))));
}

TEST(LivePlayerTest, ABoardThatStaysDeadEndsTheStreamWithItsName) {
  ChildTactusd server;
  ASSERT_NE(server.port(), 0);
  FakeArm arm(4, 0.01);
  arm.bus.copies = [&](const CanFrame&) {
    if (arm.clock.NowNs() > 5'000'000'000) arm.boards.fault(0).dead = true;
    return 1;
  };
  LivePlayer player(
      MakeChannel(server.address()), &arm.driver, {}, [](const LiveContact&) {},
      [](const std::string&) {});
  const absl::Status status = player.Run();
  EXPECT_EQ(ReasonOf(status), "IO");
  EXPECT_THAT(std::string(status.message()), HasSubstr("skin board 1"));
  EXPECT_EQ(arm.driver.state(), DriverState::kFinalised);
}

TEST(LivePlayerTest, ASkinThatTheModelWasNotTrainedOnIsRefused) {
  ChildTactusd server;
  ASSERT_NE(server.port(), 0);
  ManualClock clock;
  IcubBoards boards({{.address = 1}},
                    [](int64_t, size_t, std::span<double>) {});
  MemoryBus bus(&boards, &clock);
  icub::IcubSkin skin(*icub::PortPatch({{.address = 1}}), {.period_ms = 10});
  CanSkinDriver driver(&bus, &skin, {}, &clock);
  LivePlayer player(
      MakeChannel(server.address()), &driver, {}, [](const LiveContact&) {},
      [](const std::string&) {});
  const absl::Status status = player.Run();
  EXPECT_THAT(std::string(status.message()), HasSubstr("icub-port-192"));
}

}  // namespace
}  // namespace tactus::internal::client
