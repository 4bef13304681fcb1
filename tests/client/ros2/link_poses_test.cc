#include "client/ros2/link_poses.h"

#include <cstdlib>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/kinematics/arm_model.h"
#include "core/files/file_bytes.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/import/bag_samples.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;

constexpr int64_t kMs = 1'000'000;

DdsMessage PoseMessage(int64_t stamp_ns, double x) {
  CdrText text;
  text.Put(static_cast<int32_t>(stamp_ns / 1'000'000'000))
      .Put(static_cast<uint32_t>(stamp_ns % 1'000'000'000))
      .PutText("world");
  for (const double each : {x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}) text.Put(each);
  return {text.Done(), 77};
}

TEST(LinkPosesTest, AFrameGetsTheLastPoseBeforeIt) {
  const auto poses = LinkPoses::FromPoses({.max_age_ns = 50 * kMs});
  EXPECT_FALSE(poses->PoseAt(5));
  EXPECT_EQ(poses->Problem(), "no pose has come");
  ASSERT_TRUE(poses->Take(PoseMessage(100 * kMs, 1)).ok());
  ASSERT_TRUE(poses->Take(PoseMessage(110 * kMs, 2)).ok());
  EXPECT_FALSE(poses->PoseAt(99 * kMs));
  EXPECT_THAT(poses->Problem(), HasSubstr("later than the frame"));
  EXPECT_EQ(poses->PoseAt(109 * kMs)->x, 1);
  EXPECT_EQ(poses->PoseAt(110 * kMs)->x, 2);
  EXPECT_EQ(poses->PoseAt(160 * kMs)->x, 2);
  EXPECT_EQ(poses->Problem(), "");
  EXPECT_FALSE(poses->PoseAt(161 * kMs));
  EXPECT_THAT(poses->Problem(), HasSubstr("51 ms older"));
  // Without a stamp, when it was published.
  ASSERT_TRUE(poses->Take(PoseMessage(0, 3)).ok());
  EXPECT_EQ(poses->PoseAt(80)->x, 3);
  EXPECT_FALSE(poses->Take({"no message", 0}).ok());
}

TEST(LinkPosesTest, APlayedBagBeginsAgain) {
  const auto poses = LinkPoses::FromPoses({.max_age_ns = 50 * kMs});
  ASSERT_TRUE(poses->Take(PoseMessage(9'000 * kMs, 1)).ok());
  ASSERT_TRUE(poses->Take(PoseMessage(100 * kMs, 2)).ok());
  EXPECT_EQ(poses->PoseAt(110 * kMs)->x, 2);
  EXPECT_FALSE(poses->PoseAt(9'000 * kMs));
}

std::string Panda() {
  return *ReadFileBytes(std::string(std::getenv("TACTUS_SOURCE_DIR")) +
                            "/tests/golden/kinematics/panda.urdf",
                        1 << 20);
}

DdsMessage JointMessage(int64_t stamp_ns, const std::vector<std::string>& names,
                        const std::vector<double>& positions) {
  CdrText text;
  text.Put(static_cast<int32_t>(stamp_ns / 1'000'000'000))
      .Put(static_cast<uint32_t>(stamp_ns % 1'000'000'000))
      .PutText("");
  text.Put(static_cast<uint32_t>(names.size()));
  for (const std::string& name : names) text.PutText(name);
  text.PutList(positions);
  text.PutList(std::vector<double>{}).PutList(std::vector<double>{});
  return {text.Done(), 77};
}

// The robot's own order of joints, and a gripper that does not matter.
TEST(LinkPosesTest, JointsAreTakenByTheirNames) {
  auto arm = ArmModel::FromUrdf(Panda(), "link8");
  if (!TACTUS_WITH_URDF) GTEST_SKIP() << arm.status();
  ASSERT_TRUE(arm.ok()) << arm.status();
  std::vector<std::string> names = {"finger"};
  std::vector<double> values = {0.02};
  std::vector<double> in_order;
  for (size_t i = 0; i < arm->joints().size(); ++i) {
    const ArmJoint& joint = arm->joints()[i];
    in_order.push_back((joint.lower + joint.upper) / 2 +
                       0.05 * static_cast<double>(i));
  }
  for (size_t i = in_order.size(); i-- > 0;) {
    names.push_back(arm->joints()[i].name);
    values.push_back(in_order[i]);
  }
  const auto poses = LinkPoses::FromJoints(Panda(), "link8", {});
  ASSERT_TRUE(poses.ok()) << poses.status();
  // Two publishers: the last joint comes alone.
  const std::string last = names.back();
  names.pop_back();
  const double last_value = values.back();
  values.pop_back();
  for (int64_t t = 1'000; t < 1'050; t += 10) {
    ASSERT_TRUE((*poses)->Take(JointMessage(t * kMs, names, values)).ok());
  }
  EXPECT_FALSE((*poses)->PoseAt(1'030 * kMs));
  EXPECT_EQ((*poses)->Problem(), "nobody publishes the joint " + last);
  for (int64_t t = 1'050; t < 1'100; t += 10) {
    ASSERT_TRUE(
        (*poses)->Take(JointMessage(t * kMs, {last}, {last_value})).ok());
    ASSERT_TRUE((*poses)->Take(JointMessage(t * kMs, names, values)).ok());
  }
  const auto pose = (*poses)->PoseAt(1'075 * kMs);
  ASSERT_TRUE(pose) << (*poses)->Problem();
  const Pose want = *arm->PoseOf(in_order);
  EXPECT_NEAR(pose->x, want.position.x(), 1e-12);
  EXPECT_NEAR(pose->y, want.position.y(), 1e-12);
  EXPECT_NEAR(pose->z, want.position.z(), 1e-12);
  EXPECT_NEAR(std::abs(pose->qw), std::abs(want.orientation.w()), 1e-12);
  // Too old, and a bag that is played again.
  EXPECT_FALSE((*poses)->PoseAt(1'400 * kMs));
  for (const int64_t t : {10, 20, 30}) {
    ASSERT_TRUE((*poses)->Take(JointMessage(t * kMs + 1, names, values)).ok());
  }
}

TEST(LinkPosesTest, JointsWithoutPositionsAreRefused) {
  const auto poses = LinkPoses::FromJoints(Panda(), "link8", {});
  if (!TACTUS_WITH_URDF) GTEST_SKIP() << poses.status();
  ASSERT_TRUE(poses.ok()) << poses.status();
  EXPECT_THAT((*poses)->Take(JointMessage(5, {"a", "b"}, {1})).message(),
              HasSubstr("2 names and 1 positions"));
  const std::string good = JointMessage(5, {"a"}, {1}).bytes;
  EXPECT_FALSE((*poses)->Take({good.substr(0, 30), 0}).ok());
  EXPECT_FALSE((*poses)->Take({"", 0}).ok());
}

}  // namespace
}  // namespace tactus::internal::client
