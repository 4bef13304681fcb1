// A skin on a bus in memory: the driver's life, and what a user sees when
// something breaks.
#include "client/drivers/can_skin_driver.h"

#include <deque>

#include "client/drivers/icub_skin/icub_skin.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/memory_bus.h"
#include "tools/fakeskin/icub_boards.h"
#include "tools/fakeskin/play_peer.h"

namespace tactus::internal::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int64_t kSecondNs = 1'000'000'000;

// The pressing of every dot grows with the time, so that frames differ.
void RisingCounts(int64_t time_ns, size_t board, std::span<double> counts) {
  for (size_t i = 0; i < counts.size(); ++i) {
    counts[i] = static_cast<double>(
        (time_ns / 20'000'000 + static_cast<int64_t>(i + board)) % 50);
  }
}

// A forearm of 24 triangles at 50 Hz.
struct Forearm {
  explicit Forearm(const HardwareDriverOptions& options = {},
                   IcubBoards::Source source = RisingCounts)
      : boards(*icub::ParseBoards("forearm-v2"), std::move(source)),
        bus(&boards, &clock),
        skin(*icub::PortPatch(*icub::ParseBoards("forearm-v2")),
             {.period_ms = 20}),
        driver(&bus, &skin, options, &clock) {}

  void Start() {
    const auto info = driver.Configure();
    ASSERT_TRUE(info.ok()) << info.status();
    const absl::Status activated = driver.Activate();
    ASSERT_TRUE(activated.ok()) << activated;
  }
  // Reads for `seconds` of the bus's time; returns the frames, or the error.
  absl::StatusOr<int> ReadFor(double seconds) {
    const int64_t end_ns =
        clock.NowNs() + static_cast<int64_t>(seconds * kSecondNs);
    int frames = 0;
    while (clock.NowNs() < end_ns) {
      TACTUS_ASSIGN_OR_RETURN(const ReadResult result, driver.Read(frame));
      if (result != ReadResult::kFrame) continue;
      ++frames;
      EXPECT_GT(frame.capture_time_ns, last_ns);
      last_ns = frame.capture_time_ns;
      missing += frame.missing_before;
    }
    return frames;
  }

  ManualClock clock;
  IcubBoards boards;
  MemoryBus bus;
  icub::IcubSkin skin;
  CanSkinDriver driver;
  SkinFrame frame;
  int64_t last_ns = 0;
  uint64_t missing = 0;
};

TEST(CanSkinDriverTest, TheSkinIsConfiguredInTheFirmwaresOrder) {
  Forearm arm;
  arm.Start();
  std::vector<std::pair<uint32_t, int>> order;
  for (const CanFrame& frame : arm.bus.sent) {
    if (frame.id != 0x20D) continue;
    order.emplace_back(frame.data[0],
                       frame.data[0] == 0x07 ? frame.data[1] : -1);
  }
  // Stop, configure the board and its triangles, then a start, a stop after the
  // scans that Configure listens to, and the start by Activate.
  EXPECT_THAT(order, ElementsAre(std::pair(0x07, 1), std::pair(0x4D, -1),
                                 std::pair(0x50, -1), std::pair(0x07, 0),
                                 std::pair(0x07, 1), std::pair(0x07, 0)));
}

TEST(CanSkinDriverTest, NothingIsLostAt50Hz) {
  Forearm arm;
  arm.Start();
  const auto frames = arm.ReadFor(60);
  ASSERT_TRUE(frames.ok()) << frames.status();
  EXPECT_NEAR(*frames, 3'000, 1);
  EXPECT_EQ(arm.missing, 0u);
  const DriverStatistics statistics = arm.driver.Statistics();
  EXPECT_EQ(statistics.lost, 0u);
  EXPECT_EQ(statistics.incomplete, 0u);
  EXPECT_NEAR(statistics.rate_hz, 50, 0.01);
  EXPECT_LT(statistics.jitter_ms, 0.01);
  // A scan takes 32 frames of 0.13 ms.
  EXPECT_LT(statistics.longest_age_ms, 5);
  EXPECT_TRUE(statistics.connected);
  EXPECT_THAT(statistics.problem, IsEmpty());
}

TEST(CanSkinDriverTest, AFrameHoldsWhatWasPressed) {
  // Dot 5 of triangle 3 of the second board, by 30 counts, after 3 s.
  Forearm arm({}, [](int64_t time_ns, size_t board, std::span<double> counts) {
    if (board == 1 && time_ns > 3 * kSecondNs) counts[3 * 12 + 5] = 30;
  });
  arm.Start();
  ASSERT_TRUE(arm.ReadFor(3).ok());
  for (size_t i = 0; i < arm.frame.u16.size(); ++i) {
    EXPECT_EQ(arm.frame.u16[i], i == 192 + 3 * 12 + 5 ? 30 : 0) << i;
  }
}

// Hands on what boards send 60 ms late, as a busy host does.
class LatePeer : public CanPeer {
 public:
  explicit LatePeer(CanPeer* peer) : peer_(peer) {}
  void OnFrame(const CanFrame& frame, int64_t now_ns) override {
    Pull(now_ns);
    peer_->OnFrame(frame, now_ns);
  }
  int64_t NextNs() override {
    const int64_t next_ns = peer_->NextNs();
    return waiting_.empty()
               ? next_ns
               : std::min(next_ns, waiting_.front().time_ns + kDelayNs);
  }
  bool Emit(int64_t now_ns, CanFrame& frame) override {
    Pull(now_ns);
    if (waiting_.empty() || waiting_.front().time_ns + kDelayNs > now_ns) {
      return false;
    }
    frame = waiting_.front();
    waiting_.pop_front();
    return true;
  }

 private:
  static constexpr int64_t kDelayNs = 60'000'000;

  void Pull(int64_t now_ns) {
    for (CanFrame frame; peer_->Emit(now_ns, frame);) waiting_.push_back(frame);
  }

  CanPeer* const peer_;
  std::deque<CanFrame> waiting_;
};

TEST(CanSkinDriverTest, ScansFromBeforeTheStartAreNotItsFirstFrames) {
  ManualClock clock;
  IcubBoards boards({{.address = 1}}, RisingCounts);
  LatePeer late(&boards);
  MemoryBus bus(&late, &clock);
  icub::IcubSkin skin(*icub::PortPatch({{.address = 1}}), {.period_ms = 20});
  CanSkinDriver driver(&bus, &skin, {}, &clock);
  ASSERT_TRUE(driver.Configure().ok());
  clock.SleepNs(100'000'000);
  const int64_t start_ns = clock.NowNs();
  ASSERT_TRUE(driver.Activate().ok());
  SkinFrame frame;
  for (int frames = 0; frames < 20;) {
    if (*driver.Read(frame) != ReadResult::kFrame) continue;
    ++frames;
    EXPECT_GE(frame.capture_time_ns, start_ns);
    EXPECT_EQ(frame.missing_before, 0u);
  }
}

TEST(CanSkinDriverTest, ACellOfSeveralTaxelsHasTheLargest) {
  ManualClock clock;
  IcubBoards boards({{.address = 1}},
                    [](int64_t time_ns, size_t, std::span<double> counts) {
                      if (time_ns > 3 * kSecondNs)
                        counts[3] = 9, counts[4] = 30, counts[5] = 12;
                    });
  MemoryBus bus(&boards, &clock);
  icub::SkinPatch patch = *icub::PortPatch({{.address = 1}});
  patch.cells[4] = patch.cells[5] = 3;
  icub::IcubSkin skin(patch, {});
  CanSkinDriver driver(&bus, &skin, {}, &clock);
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  SkinFrame frame;
  while (clock.NowNs() < 4 * kSecondNs) ASSERT_TRUE(driver.Read(frame).ok());
  EXPECT_EQ(frame.u16[3], 30);
  EXPECT_EQ(frame.u16[4], 0);
}

TEST(CanSkinDriverTest, StatesAndCallsAreChecked) {
  Forearm arm;
  SkinFrame frame;
  EXPECT_EQ(ReasonOf(arm.driver.Activate()), "INVALID_CONFIG");
  arm.Start();
  EXPECT_TRUE(arm.boards.IsSending(0));
  EXPECT_TRUE(arm.driver.Deactivate().ok());
  EXPECT_FALSE(arm.boards.IsSending(0));
  EXPECT_EQ(ReasonOf(arm.driver.Read(frame).status()), "INVALID_CONFIG");
  EXPECT_TRUE(arm.driver.Activate().ok());
  EXPECT_TRUE(arm.boards.IsSending(1));
  EXPECT_TRUE(arm.driver.Finalise().ok());
  EXPECT_EQ(arm.driver.state(), DriverState::kFinalised);
  EXPECT_FALSE(arm.boards.IsSending(1));
  EXPECT_TRUE(arm.driver.Finalise().ok());
  EXPECT_EQ(ReasonOf(arm.driver.Configure().status()), "INVALID_CONFIG");
}

TEST(CanSkinDriverTest, WhatIsNotSentWhileInactiveIsNotLost) {
  Forearm arm;
  arm.Start();
  ASSERT_TRUE(arm.ReadFor(1).ok());
  ASSERT_TRUE(arm.driver.Deactivate().ok());
  arm.clock.SleepNs(5 * kSecondNs);
  ASSERT_TRUE(arm.driver.Activate().ok());
  EXPECT_NEAR(*arm.ReadFor(1), 50, 1);
  EXPECT_EQ(arm.missing, 0u);
  EXPECT_EQ(arm.driver.Statistics().lost, 0u);
}

// One frame in 0.255 s, and the patience of a fast skin.
TEST(CanSkinDriverTest, ASlowSkinIsNotSilent) {
  ManualClock clock;
  IcubBoards boards({{.address = 1}}, RisingCounts);
  MemoryBus bus(&boards, &clock);
  icub::IcubSkin skin(*icub::PortPatch({{.address = 1}}), {.period_ms = 255});
  CanSkinDriver driver(&bus, &skin, {.silence_ns = 100'000'000}, &clock);
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  SkinFrame frame;
  const int64_t end_ns = clock.NowNs() + 10 * kSecondNs;
  int frames = 0;
  while (clock.NowNs() < end_ns) {
    frames += *driver.Read(frame) == ReadResult::kFrame;
  }
  EXPECT_NEAR(frames, 39, 1);
  EXPECT_EQ(driver.Statistics().problem, "");
}

TEST(CanSkinDriverTest, ADriverThatIsDestroyedStopsTheSkin) {
  ManualClock clock;
  IcubBoards boards({{.address = 1}}, RisingCounts);
  MemoryBus bus(&boards, &clock);
  icub::IcubSkin skin(*icub::PortPatch({{.address = 1}}), {});
  {
    CanSkinDriver driver(&bus, &skin, {}, &clock);
    ASSERT_TRUE(driver.Configure().ok());
    ASSERT_TRUE(driver.Activate().ok());
    EXPECT_TRUE(boards.IsSending(0));
  }
  EXPECT_FALSE(boards.IsSending(0));
}

TEST(CanSkinDriverTest, ConfigureNamesTheBoardThatDoesNotAnswer) {
  Forearm arm;
  arm.boards.fault(1).dead = true;
  const absl::Status status = arm.driver.Configure().status();
  EXPECT_EQ(ReasonOf(status), "IO");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("skin board 12 does not answer (boards that do: 13)"));
  EXPECT_EQ(arm.driver.state(), DriverState::kUnconfigured);
  // Once it has power, the same driver works.
  arm.boards.fault(1).dead = false;
  arm.Start();
}

TEST(CanSkinDriverTest, ConfigureNamesABoardInItsBootloader) {
  Forearm arm;
  arm.boards.fault(0).in_bootloader = true;
  EXPECT_THAT(std::string(arm.driver.Configure().status().message()),
              HasSubstr("board 13 runs its bootloader"));
}

TEST(CanSkinDriverTest, ConfigureMasksTrianglesThatAreNotThere) {
  Forearm arm;
  arm.boards.fault(0).not_connected = 1 << 4;
  arm.boards.fault(1).no_answer = 1 << 3;
  const auto info = arm.driver.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(std::count(info->layout.mask.begin(), info->layout.mask.end(), 1),
            220);
  EXPECT_THAT(arm.driver.Statistics().remarks,
              HasSubstr("board 13: triangle 4 masked"));
  EXPECT_THAT(arm.driver.Statistics().remarks,
              HasSubstr("board 12: triangle 3 masked"));
  // The others stream.
  ASSERT_TRUE(arm.driver.Activate().ok());
  EXPECT_NEAR(*arm.ReadFor(1), 50, 1);
  EXPECT_EQ(arm.missing, 0u);
}

TEST(CanSkinDriverTest, LostFramesAreCountedAndNeverInvented) {
  Forearm arm;
  arm.Start();
  int count = 0;
  // One CAN frame in 480, that is one scan in ten.
  arm.bus.copies = [&](const CanFrame&) { return ++count % 480 == 0 ? 0 : 1; };
  const auto frames = arm.ReadFor(20);
  ASSERT_TRUE(frames.ok()) << frames.status();
  EXPECT_NEAR(*frames, 900, 5);
  EXPECT_NEAR(static_cast<double>(arm.missing), 100, 5);
  EXPECT_NEAR(static_cast<double>(*frames + arm.missing), 1'000, 2);
  EXPECT_EQ(arm.driver.Statistics().lost, arm.missing);
  EXPECT_GE(arm.driver.Statistics().incomplete, 99u);
  EXPECT_EQ(arm.driver.Statistics().reconnects, 0u);
}

TEST(CanSkinDriverTest, RepeatedFramesChangeNothing) {
  Forearm arm;
  arm.Start();
  arm.bus.copies = [](const CanFrame&) { return 2; };
  EXPECT_NEAR(*arm.ReadFor(10), 500, 1);
  EXPECT_EQ(arm.driver.Statistics().lost, 0u);
  EXPECT_EQ(arm.driver.Statistics().incomplete, 0u);
}

// Unplugged: no frames, the reason in the statistics; replugged: frames go on,
// the gap is counted, and the skin was not tared under a touch.
TEST(SkinFaultTest, AnAdapterThatIsUnpluggedAndComesBack) {
  Forearm arm;
  arm.Start();
  ASSERT_TRUE(arm.ReadFor(2).ok());
  const size_t sent = arm.bus.sent.size();
  arm.bus.gone = "the adapter is gone";
  const auto away = arm.ReadFor(5);
  ASSERT_TRUE(away.ok()) << away.status();
  EXPECT_EQ(*away, 0);
  EXPECT_FALSE(arm.driver.Statistics().connected);
  EXPECT_THAT(arm.driver.Statistics().problem, HasSubstr("adapter is gone"));
  arm.bus.gone.clear();
  const auto back = arm.ReadFor(10);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_GT(*back, 50);
  const DriverStatistics statistics = arm.driver.Statistics();
  EXPECT_TRUE(statistics.connected);
  EXPECT_EQ(statistics.reconnects, 1u);
  EXPECT_GE(arm.missing, 250u);
  EXPECT_EQ(statistics.lost, arm.missing);
  EXPECT_GT(arm.bus.sent.size(), sent);
}

TEST(SkinFaultTest, AShortBreakDoesNotTareTheSkin) {
  Forearm arm;
  arm.Start();
  ASSERT_TRUE(arm.ReadFor(1).ok());
  const size_t sent = arm.bus.sent.size();
  // Bus-off: Receive fails once, and Open restarts the controller.
  arm.bus.broken = "bus-off";
  const int opens = arm.bus.opens;
  const auto frames = arm.ReadFor(2);
  ASSERT_TRUE(frames.ok()) << frames.status();
  EXPECT_GT(*frames, 85);
  EXPECT_EQ(arm.bus.opens, opens + 1);
  EXPECT_EQ(arm.driver.Statistics().reconnects, 1u);
  EXPECT_THAT(arm.driver.Statistics().problem, HasSubstr("bus-off"));
  // Only starts were sent.
  for (size_t i = sent; i < arm.bus.sent.size(); ++i) {
    EXPECT_EQ(arm.bus.sent[i].data[0], 0x07);
    EXPECT_EQ(arm.bus.sent[i].data[1], 0x00);
  }
}

TEST(SkinFaultTest, ADeadBoardIsNamedAndComesBack) {
  Forearm arm;
  arm.Start();
  ASSERT_TRUE(arm.ReadFor(1).ok());
  arm.boards.fault(1).dead = true;
  const auto without = arm.ReadFor(1.2);
  ASSERT_TRUE(without.ok()) << without.status();
  EXPECT_LE(*without, 1);
  EXPECT_THAT(arm.driver.Statistics().problem,
              HasSubstr("board 12 sends nothing"));
  ASSERT_TRUE(arm.ReadFor(5).ok());
  EXPECT_THAT(arm.driver.Statistics().problem,
              HasSubstr("skin board 12 does not answer"));
  // It has lost its configuration and gets it again.
  arm.boards.fault(1).dead = false;
  const auto with = arm.ReadFor(10);
  ASSERT_TRUE(with.ok()) << with.status();
  EXPECT_GT(*with, 100);
  EXPECT_TRUE(arm.driver.Statistics().connected);
}

TEST(SkinFaultTest, ABoardThatStaysDeadEndsTheStream) {
  Forearm arm;
  arm.Start();
  ASSERT_TRUE(arm.ReadFor(1).ok());
  arm.boards.fault(0).dead = true;
  const absl::Status status = arm.ReadFor(60).status();
  EXPECT_EQ(ReasonOf(status), "IO");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("no frame for 30 s: memory: skin board 13"));
  // For good, and the driver can be ended.
  EXPECT_FALSE(arm.driver.Read(arm.frame).ok());
  EXPECT_TRUE(arm.driver.Finalise().ok());
}

TEST(SkinFaultTest, ATriangleThatFailsEndsTheStreamWithItsName) {
  Forearm arm;
  arm.Start();
  ASSERT_TRUE(arm.ReadFor(1).ok());
  arm.boards.fault(0).no_answer = 1 << 7;
  const absl::Status status = arm.ReadFor(60).status();
  EXPECT_EQ(ReasonOf(status), "IO");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("board 13: triangle 7 masked"));
  EXPECT_THAT(std::string(status.message()), HasSubstr("begin a new stream"));
}

// An arm whose pose is known except between two times.
struct ForgetfulArm {
  std::optional<Pose> At(int64_t time_ns) const {
    if (time_ns >= from_ns && time_ns < until_ns) return std::nullopt;
    return Pose{.position = {0, 0, static_cast<double>(time_ns) / 1e9}};
  }
  HardwareDriverOptions Options() const {
    return {.pose_at = [this](int64_t time_ns) { return At(time_ns); },
            .pose_problem = [] { return "the encoders sleep"; }};
  }

  int64_t from_ns = 0;
  int64_t until_ns = 0;
};

TEST(SkinPoseTest, FramesWithoutAPoseAreLostAndCounted) {
  ForgetfulArm poses;
  Forearm arm(poses.Options());
  arm.Start();
  ASSERT_TRUE(arm.ReadFor(2).ok());
  EXPECT_EQ(arm.frame.pose.position.z(),
            static_cast<double>(arm.frame.capture_time_ns) / 1e9);
  poses.from_ns = arm.clock.NowNs();
  poses.until_ns = poses.from_ns + 2 * kSecondNs;
  const auto during = arm.ReadFor(0.9);
  ASSERT_TRUE(during.ok()) << during.status();
  EXPECT_EQ(*during, 0);
  // Not yet: a single frame is no problem.
  EXPECT_THAT(arm.driver.Statistics().pose_problem, IsEmpty());
  ASSERT_TRUE(arm.ReadFor(0.5).ok());
  EXPECT_EQ(arm.driver.Statistics().pose_problem, "the encoders sleep");
  // The skin itself is well.
  EXPECT_TRUE(arm.driver.Statistics().connected);
  const auto after = arm.ReadFor(2);
  ASSERT_TRUE(after.ok()) << after.status();
  EXPECT_NEAR(*after, 70, 2);
  const DriverStatistics statistics = arm.driver.Statistics();
  EXPECT_NEAR(static_cast<double>(statistics.without_pose), 100, 1);
  EXPECT_EQ(statistics.lost, statistics.without_pose);
  EXPECT_EQ(arm.missing, statistics.without_pose);
  EXPECT_THAT(statistics.pose_problem, IsEmpty());
  EXPECT_EQ(statistics.reconnects, 0u);
}

TEST(SkinPoseTest, PosesThatStayAwayEndTheStreamWithTheReason) {
  ForgetfulArm poses;
  Forearm arm(poses.Options());
  arm.Start();
  ASSERT_TRUE(arm.ReadFor(2).ok());
  poses.from_ns = arm.clock.NowNs();
  poses.until_ns = poses.from_ns + 100 * kSecondNs;
  ASSERT_TRUE(arm.ReadFor(29).ok());
  const auto end = arm.ReadFor(2);
  EXPECT_EQ(ReasonOf(end.status()), "IO");
  EXPECT_THAT(std::string(end.status().message()),
              HasSubstr("no poses for 30 s: the encoders sleep"));
}

// The 30 s begin anew: while the skin is away, no pose is asked for.
TEST(SkinPoseTest, ABreakOfTheSkinIsNoWantOfPoses) {
  ForgetfulArm poses;
  Forearm arm(poses.Options());
  arm.Start();
  ASSERT_TRUE(arm.ReadFor(2).ok());
  poses.from_ns = arm.clock.NowNs();
  poses.until_ns = poses.from_ns + 38 * kSecondNs;
  ASSERT_TRUE(arm.ReadFor(15).ok());
  arm.bus.gone = "unplugged";
  ASSERT_TRUE(arm.ReadFor(10).ok());
  EXPECT_THAT(arm.driver.Statistics().pose_problem, IsEmpty());
  arm.bus.gone.clear();
  const auto after = arm.ReadFor(25);
  ASSERT_TRUE(after.ok()) << after.status();
  EXPECT_GT(*after, 400);
}

TEST(SkinFaultTest, AStuckTaxelIsListedAndNotHidden) {
  Forearm arm;
  arm.boards.fault(0).stuck[26] = 200;
  arm.Start();
  ASSERT_TRUE(arm.ReadFor(11).ok());
  EXPECT_EQ(arm.frame.u16[26], 45);
  EXPECT_THAT(arm.driver.Statistics().stuck_taxels, ElementsAre(26));
}

TEST(SkinFaultTest, GarbageOnTheBusDoesNotReachTheStream) {
  Forearm arm;
  arm.Start();
  Random random(11);
  int frames = 0;
  for (int i = 0; i < 500; ++i) {
    for (int g = 0; g < 20; ++g) {
      CanFrame junk;
      // Any id but that of a part of a triangle of these boards.
      junk.id = static_cast<uint32_t>(random.Index(0x800));
      junk.extended = random.Index(4) == 0;
      junk.size = static_cast<uint8_t>(random.Index(9));
      for (uint8_t& byte : junk.data) {
        byte = static_cast<uint8_t>(random.Index(256));
      }
      junk.time_ns = arm.clock.NowNs();
      if (junk.data[0] == 0x40 || junk.data[0] == 0xC0) junk.data[0] = 0;
      arm.bus.garbage.push_back(junk);
    }
    const auto result = arm.driver.Read(arm.frame);
    ASSERT_TRUE(result.ok()) << result.status();
    frames += *result == ReadResult::kFrame;
  }
  EXPECT_EQ(frames, 500);
  EXPECT_EQ(arm.driver.Statistics().lost, 0u);
  EXPECT_GT(arm.skin.assembler()->counters(0).malformed, 0u);
}

// A host on the other end of the bus: asks who is there.
class AskingHost : public CanPeer {
 public:
  void OnFrame(const CanFrame& frame, int64_t /*now_ns*/) override {
    if (const auto reply = icub::ReadReply(frame)) replies.push_back(*reply);
  }
  int64_t NextNs() override { return asked_ ? kNever : 2'000'000'000; }
  bool Emit(int64_t now_ns, CanFrame& frame) override {
    if (now_ns < NextNs()) return false;
    asked_ = true;
    frame = icub::Discover();
    frame.time_ns = now_ns;
    return true;
  }
  std::vector<icub::BoardReply> replies;

 private:
  bool asked_ = false;
};

TEST(PlayPeerTest, SimulatedBoardsAnswerOnABus) {
  ManualClock clock;
  AskingHost host;
  MemoryBus bus(&host, &clock);
  IcubBoards boards({{.address = 4}, {.address = 5}}, RisingCounts);
  const absl::Status status = PlayPeer(
      boards, bus, clock, [&] { return clock.NowNs() < 3 * kSecondNs; });
  EXPECT_TRUE(status.ok()) << status;
  ASSERT_EQ(host.replies.size(), 2u);
  EXPECT_TRUE(host.replies[0].HasSkin());
  bus.gone = "pulled out";
  EXPECT_EQ(ReasonOf(PlayPeer(boards, bus, clock, [] { return true; })), "IO");
}

}  // namespace
}  // namespace tactus::internal::client
