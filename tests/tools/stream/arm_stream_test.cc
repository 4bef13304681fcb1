// The whole path of a skin on a moving arm: joint values by UDP, a URDF, the
// iCub's driver on a bus in memory, and a real tactusd with its default model,
// which needs poses.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/drivers/can_skin_driver.h"
#include "client/drivers/icub_skin/icub_skin.h"
#include "client/kinematics/joint_poses.h"
#include "core/base/errors.h"
#include "core/files/file_bytes.h"
#include "core/skin/geometry.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/memory_bus.h"
#include "tests/client/drivers/until_last_touch.h"
#include "tests/support/child_tactusd.h"
#include "tools/common/arm_source.h"
#include "tools/common/skin_source.h"
#include "tools/fakeskin/sim_touches.h"
#include "tools/stream/live_player.h"

namespace tactus::internal::client {
namespace {

using testing::ChildTactusd;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr int64_t kBeginNs = 3'000'000'000;
constexpr int64_t kPeriodNs = 10'000'000;
// Where the skin's link rests.
const Eigen::Vector3d kRest(0.5, 0.3, 0.2);

std::string ScaraFile() {
  const char* root = std::getenv("TACTUS_SOURCE_DIR");
  return std::string(root == nullptr ? "." : root) +
         "/tests/golden/kinematics/scara.urdf";
}

// The joint values that put the skin of scara.urdf at `position`, unturned:
// lift, shoulder, elbow, wrist.
std::vector<double> ScaraValues(const Eigen::Vector3d& position) {
  const double x = position.x() - 0.05;
  const double y = position.y();
  const double cosine = (x * x + y * y) / (2 * 0.4 * 0.4) - 1;
  const double elbow = std::acos(cosine);
  const double shoulder =
      std::atan2(y, x) - std::atan2(std::sin(elbow), 1 + std::cos(elbow));
  return {position.z() - 0.02, shoulder, elbow, -shoulder - elbow};
}

// Simulated contacts at the seam of a forearm's skin. The arm's joint values
// come 100 times a second, `lag_ns` late.
struct ScaraSkin {
  ScaraSkin(size_t contacts, int64_t lag_ns)
      : lag_ns(lag_ns),
        touches({.seed = 5,
                 .contacts = contacts,
                 .begin_ns = kBeginNs,
                 .centre = SkinPoint{8, 23.7},
                 .newton_per_count = 0.01}),
        boards(touches.patch().boards, touches.Source()),
        bus(&boards, &clock),
        skin(touches.patch(), {.period_ms = 10, .scale = 0.01}),
        poses(
            *ArmModel::FromUrdf(*ReadFileBytes(ScaraFile(), 1 << 20), "skin")),
        driver(&bus, &skin,
               {.pose_at = [this](int64_t time_ns) { return PoseAt(time_ns); },
                .pose_problem = [this] { return poses.Problem(); }},
               &clock) {}

  std::optional<Pose> PoseAt(int64_t time_ns) {
    while (next_ns <= time_ns - lag_ns) {
      if (next_ns < silent_from_ns || next_ns >= silent_until_ns) {
        const Pose link = touches.PoseAt(next_ns);
        const absl::Status pushed =
            poses.Push(next_ns, ScaraValues(kRest + link.position));
        EXPECT_TRUE(pushed.ok()) << pushed;
      }
      next_ns += kPeriodNs;
    }
    return poses.PoseAt(time_ns);
  }

  const int64_t lag_ns;
  ManualClock clock;
  SimTouches touches;
  IcubBoards boards;
  MemoryBus bus;
  icub::IcubSkin skin;
  JointPoses poses;
  CanSkinDriver driver;
  int64_t next_ns = kBeginNs - 2'000'000'000;
  // The robot's program sends nothing.
  int64_t silent_from_ns = 0;
  int64_t silent_until_ns = 0;
};

struct PlayResult {
  absl::Status status;
  int felt = 0;
  int right = 0;
  uint64_t lost = 0;
  uint64_t without_pose = 0;
  // Largest distance of a contact's place from the middle of where it was
  // simulated, m: across the arm, and along it.
  double farthest_m = 0;
  double farthest_along_m = 0;
  int placed = 0;
  std::vector<std::string> news;

  double accuracy() const { return felt == 0 ? 0 : double(right) / felt; }
};

PlayResult Play(ScaraSkin& arm) {
  const ChildTactusd server;
  PlayResult result;
  const LivePlayer* self = nullptr;
  const Eigen::Vector3d centre =
      LinkPosition(arm.touches.patch().layout, {8, 23.7});
  UntilLastTouch driver(&arm.driver, &arm.touches, &arm.clock);
  LivePlayer player(
      MakeChannel(server.address()), &driver,
      {.pose_at = [&](int64_t t) { return arm.poses.PoseAt(t); }},
      [&](const LiveContact& contact) {
        ++result.felt;
        const std::string label = arm.touches.LabelAt(contact.onset_ns);
        result.right += self->class_names()[contact.answer] == label;
        if (!contact.place) return;
        ++result.placed;
        const Eigen::Vector3d truth =
            kRest + arm.touches.PoseAt(contact.onset_ns).position + centre;
        // The objects are lines along the arm. Which taxel feels one first is
        // a matter of chance, so only the way around the arm is compared.
        const Eigen::Vector3d error = *contact.place - truth;
        result.farthest_m = std::max(result.farthest_m, error.head<2>().norm());
        result.farthest_along_m =
            std::max(result.farthest_along_m, std::abs(error.z()));
      },
      [&](const std::string& text) { result.news.push_back(text); });
  self = &player;
  result.status = player.Run();
  result.lost = player.statistics().lost;
  result.without_pose = player.statistics().without_pose;
  return result;
}

TEST(ArmStreamTest, AMovingArmsContactsAreClassifiedAndPlaced) {
  constexpr size_t kContacts = 40;
  for (const int64_t lag_ns : {-kPeriodNs, 3 * kPeriodNs / 10}) {
    ScaraSkin arm(kContacts, lag_ns);
    const PlayResult result = Play(arm);
    ASSERT_TRUE(result.status.ok()) << result.status;
    std::printf(
        "joint values %+.0f ms late: %d of %zu contacts felt, accuracy %.3f, "
        "places within %.1f mm around the arm\n",
        static_cast<double>(lag_ns) / 1e6, result.felt, kContacts,
        result.accuracy(), 1e3 * result.farthest_m);
    EXPECT_EQ(result.lost, 0u);
    EXPECT_EQ(result.without_pose, 0u);
    EXPECT_GE(result.felt, 30);
    EXPECT_GE(result.accuracy(), 0.9);
    EXPECT_EQ(result.placed, result.felt);
    // Less than a taxel, and the diameter is eight; half of a line.
    EXPECT_LT(result.farthest_m, 0.01);
    EXPECT_LT(result.farthest_along_m, 0.08);
  }
}

TEST(ArmStreamTest, JointValuesThatStayAwayAreReported) {
  ScaraSkin arm(4, -kPeriodNs);
  arm.silent_from_ns = kBeginNs + 1'000'000'000;
  arm.silent_until_ns = kBeginNs + 6'000'000'000;
  const PlayResult result = Play(arm);
  ASSERT_TRUE(result.status.ok()) << result.status;
  // 5 s but for what the newest values bridge.
  EXPECT_NEAR(static_cast<double>(result.without_pose), 498, 2);
  EXPECT_EQ(result.lost, result.without_pose);
  EXPECT_THAT(result.news,
              Contains(HasSubstr("frames are lost without poses: the newest "
                                 "joint values are ")));
  EXPECT_THAT(result.news, Contains(HasSubstr("poses come again; ")));
}

TEST(ArmStreamTest, JointValuesThatStayAwayForGoodEndTheStream) {
  ScaraSkin arm(20, -kPeriodNs);
  arm.silent_until_ns = kBeginNs + 1'000'000'000'000;
  const PlayResult result = Play(arm);
  EXPECT_EQ(ReasonOf(result.status), "IO") << result.status;
  EXPECT_THAT(std::string(result.status.message()),
              HasSubstr("frames come, but no poses for 30 s: no joint values "
                        "have come"));
}

void SendTo(int port, const std::string& text) {
  sockaddr_in to = {};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<uint16_t>(port));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
  EXPECT_EQ(sendto(socket, text.data(), text.size(), 0,
                   reinterpret_cast<sockaddr*>(&to), sizeof(to)),
            static_cast<ssize_t>(text.size()));
  close(socket);
}

TEST(ArmSourceTest, FlagsDatagramsAndPosesBelongTogether) {
  const auto source = ArmSource::Make(
      {.urdf = ScaraFile(), .skin_link = "skin", .joints = "127.0.0.1:0"});
  ASSERT_TRUE(source.ok()) << source.status();
  EXPECT_EQ((*source)->Usage(),
            "joint values at 127.0.0.1:0 as: time_ns lift shoulder elbow "
            "wrist");
  const HardwareDriverOptions driver = (*source)->DriverOptions();
  const int64_t now_ns = Clock::System().NowNs();
  EXPECT_FALSE(driver.pose_at(now_ns));
  EXPECT_EQ(driver.pose_problem(), "no joint values have come");
  SendTo((*source)->port(), absl::StrCat(now_ns, " 0.1 90 0 0"));
  SendTo((*source)->port(), absl::StrCat(now_ns, " 0.1 0 1.5707963268 0"));
  std::optional<Pose> pose;
  for (int i = 0; i < 2000 && !pose; ++i) {
    Clock::System().SleepNs(5'000'000);
    pose = driver.pose_at(now_ns);
  }
  ASSERT_TRUE(pose) << driver.pose_problem();
  EXPECT_NEAR(pose->position.x(), 0.4, 1e-9);
  EXPECT_NEAR(pose->position.y(), 0.45, 1e-9);
  EXPECT_NEAR(pose->position.z(), 0.12, 1e-9);
  EXPECT_THAT(
      (*source)->Summary(),
      HasSubstr(
          "joint samples: 1 taken, 1 refused, the last: joint shoulder is 90"));
}

TEST(ArmSourceTest, FilesThatCannotBeUsedAreNamed) {
  const auto error = [](const ArmSourceOptions& options) {
    const auto source = ArmSource::Make(options);
    EXPECT_FALSE(source.ok());
    return std::string(source.status().message());
  };
  EXPECT_THAT(error({.urdf = "/nowhere.urdf",
                     .skin_link = "skin",
                     .joints = "127.0.0.1:0"}),
              HasSubstr("/nowhere.urdf"));
  EXPECT_THAT(
      error(
          {.urdf = ScaraFile(), .skin_link = "palm", .joints = "127.0.0.1:0"}),
      HasSubstr("scara.urdf: link of the skin is \"palm\"; it must be "
                "one of base, carriage"));
  EXPECT_THAT(
      error({.urdf = ScaraFile(), .skin_link = "skin", .joints = "5005"}),
      HasSubstr("--joints: address is \"5005\""));
}

TEST(ArmSourceTest, FlagsThatDoNotFitAreRefused) {
  SkinSourceOptions options;
  options.driver = "serial";
  options.port = "/dev/ttyUSB0";
  options.arm = {.urdf = "a.urdf", .skin_link = "skin", .joints = "h:1"};
  EXPECT_TRUE(CheckSkinFlags(options).ok());
  const auto error = [](const SkinSourceOptions& wrong) {
    const absl::Status status = CheckSkinFlags(wrong);
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
    return std::string(status.message());
  };
  SkinSourceOptions wrong = options;
  wrong.arm.joints.clear();
  EXPECT_THAT(error(wrong), HasSubstr("--joints is 2; it must be 3, or 0"));
  wrong = options;
  wrong.driver = "sim";
  EXPECT_THAT(error(wrong), HasSubstr("absent without a real skin"));
  wrong = options;
  wrong.icub.positions = "left.txt";
  EXPECT_THAT(error(wrong), HasSubstr("given with --positions"));
}

}  // namespace
}  // namespace tactus::internal::client
