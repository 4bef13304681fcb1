#include "client/kinematics/joint_poses.h"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <thread>
#include <vector>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/kinematics/fake_arm.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int64_t kMs = 1'000'000;

void PushAll(JointPoses& poses, int64_t from_ms, int64_t to_ms, int64_t step_ms,
             const std::function<std::vector<double>(double ms)>& values) {
  for (int64_t ms = from_ms; ms <= to_ms; ms += step_ms) {
    const absl::Status pushed =
        poses.Push(ms * kMs, values(static_cast<double>(ms)));
    ASSERT_TRUE(pushed.ok()) << pushed;
  }
}

std::vector<double> Straight(double ms) { return {0.001 * ms, 0.002 * ms}; }

TEST(JointPosesTest, ValuesAreInterpolatedBetweenTheSamplesAround) {
  JointPoses poses{FakeArm()};
  PushAll(poses, 0, 1000, 10, Straight);
  for (const double ms : {0.0, 3.0, 10.0, 555.5, 999.9, 1000.0}) {
    const auto pose = poses.PoseAt(std::llround(ms * kMs));
    ASSERT_TRUE(pose) << ms << ": " << poses.Problem();
    EXPECT_NEAR(pose->position.x(), 0.001 * ms, 1e-12) << ms;
    EXPECT_NEAR(TurnOf(*pose), 0.002 * ms, 1e-12) << ms;
    EXPECT_THAT(poses.Problem(), IsEmpty());
  }
}

// The error of a straight line between samples 10 ms apart: a dt^2 / 8.
TEST(JointPosesTest, TheErrorBetweenSamplesIsThatOfALine) {
  JointPoses poses{FakeArm()};
  const auto wave = [](double ms) -> std::vector<double> {
    return {std::sin(0.01 * ms), 0};
  };
  PushAll(poses, 0, 600, 10, wave);
  double worst = 0;
  for (int64_t us = 0; us <= 600'000; us += 100) {
    const auto pose = poses.PoseAt(us * 1000);
    ASSERT_TRUE(pose) << poses.Problem();
    const double truth = std::sin(1e-5 * static_cast<double>(us));
    worst = std::max(worst, std::abs(pose->position.x() - truth));
  }
  EXPECT_LE(worst, 0.01 * 0.01 * 100 / 8 * 1.0001);
  EXPECT_GE(worst, 0.01 * 0.01 * 100 / 8 * 0.9);
}

TEST(JointPosesTest, AnEndlessJointGoesTheShorterWay) {
  JointPoses poses{FakeArm()};
  ASSERT_TRUE(poses.Push(0, std::vector<double>{0, 3.1}).ok());
  ASSERT_TRUE(poses.Push(10 * kMs, std::vector<double>{0, -3.1}).ok());
  const auto pose = poses.PoseAt(5 * kMs);
  ASSERT_TRUE(pose) << poses.Problem();
  EXPECT_NEAR(std::abs(TurnOf(*pose)), std::numbers::pi, 1e-12);
}

TEST(JointPosesTest, TheNewestSampleIsContinuedForAShortTimeOnly) {
  JointPoses poses{FakeArm()};
  PushAll(poses, 0, 100, 10, Straight);
  auto pose = poses.PoseAt(120 * kMs);
  ASSERT_TRUE(pose) << poses.Problem();
  EXPECT_NEAR(pose->position.x(), 0.12, 1e-12);
  EXPECT_FALSE(poses.PoseAt(120 * kMs + 1));
  EXPECT_THAT(poses.Problem(), HasSubstr("20.0 ms older than the frame"));
  // And again, as soon as a sample has come.
  ASSERT_TRUE(poses.Push(110 * kMs, Straight(110)).ok());
  EXPECT_TRUE(poses.PoseAt(120 * kMs + 1));
}

// Two samples a microsecond apart say nothing of the speed.
TEST(JointPosesTest, TheLineBeginsAsFarBeforeAsItGoesBeyond) {
  JointPoses poses{FakeArm()};
  ASSERT_TRUE(poses.Push(0, std::vector<double>{0, 0}).ok());
  ASSERT_TRUE(poses.Push(10 * kMs, std::vector<double>{0.010, 0}).ok());
  ASSERT_TRUE(poses.Push(10 * kMs + 1000, std::vector<double>{0.011, 0}).ok());
  const auto pose = poses.PoseAt(15 * kMs);
  ASSERT_TRUE(pose) << poses.Problem();
  EXPECT_NEAR(pose->position.x(), 0.0165, 1e-4);
}

TEST(JointPosesTest, NoPoseIsInvented) {
  JointPoses poses{FakeArm()};
  EXPECT_FALSE(poses.PoseAt(0));
  EXPECT_EQ(poses.Problem(), "no joint values have come");
  ASSERT_TRUE(poses.Push(100 * kMs, Straight(100)).ok());
  EXPECT_TRUE(poses.PoseAt(100 * kMs));
  EXPECT_FALSE(poses.PoseAt(105 * kMs));
  EXPECT_EQ(poses.Problem(), "too few joint values have come");
  EXPECT_FALSE(poses.PoseAt(90 * kMs));
  EXPECT_THAT(poses.Problem(), HasSubstr("10.0 ms older than the oldest"));
  // A gap of 51 ms is not bridged, one of 50 ms is.
  ASSERT_TRUE(poses.Push(151 * kMs, Straight(151)).ok());
  EXPECT_FALSE(poses.PoseAt(120 * kMs));
  EXPECT_THAT(poses.Problem(), HasSubstr("51.0 ms apart; at most 50.0 ms"));
  EXPECT_TRUE(poses.PoseAt(151 * kMs));
  // Nor does a line begin before a gap.
  EXPECT_FALSE(poses.PoseAt(155 * kMs));
  EXPECT_THAT(poses.Problem(), HasSubstr("apart"));
  ASSERT_TRUE(poses.Push(201 * kMs, Straight(201)).ok());
  EXPECT_TRUE(poses.PoseAt(180 * kMs));
  EXPECT_THAT(poses.Problem(), IsEmpty());
  for (const int64_t time_ns : {std::numeric_limits<int64_t>::min(),
                                std::numeric_limits<int64_t>::max()}) {
    EXPECT_FALSE(poses.PoseAt(time_ns));
  }
}

TEST(JointPosesTest, TheRingForgetsTheOldestSamples) {
  JointPoses poses(FakeArm(), {.samples = 5});
  PushAll(poses, 0, 100, 10, Straight);
  EXPECT_FALSE(poses.PoseAt(59 * kMs));
  for (int64_t ms = 60; ms <= 100; ++ms) {
    const auto pose = poses.PoseAt(ms * kMs);
    ASSERT_TRUE(pose) << ms << ": " << poses.Problem();
    EXPECT_NEAR(pose->position.x(), 0.001 * static_cast<double>(ms), 1e-12);
  }
}

TEST(JointPosesTest, WrongSamplesAreRefusedAndChangeNothing) {
  JointPoses poses{FakeArm()};
  PushAll(poses, 0, 20, 10, Straight);
  const auto error = [&](int64_t time_ns, std::vector<double> values) {
    const absl::Status status = poses.Push(time_ns, values);
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << status;
    return std::string(status.message());
  };
  EXPECT_THAT(error(30 * kMs, {0}), HasSubstr("2: slide, turn"));
  EXPECT_THAT(error(30 * kMs, {0, std::nan("")}), HasSubstr("joint turn"));
  EXPECT_THAT(error(30 * kMs, {2.2, 0}), HasSubstr("joint slide"));
  EXPECT_THAT(error(20 * kMs, {0, 0}), HasSubstr("above"));
  EXPECT_THAT(error(limits::kMaxCaptureTimeNs + 1, {0, 0}), HasSubstr("most"));
  EXPECT_THAT(error(std::numeric_limits<int64_t>::min(), {0, 0}),
              HasSubstr("most"));
  const auto pose = poses.PoseAt(20 * kMs);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->position.x(), 0.02, 1e-12);
}

TEST(JointPosesTest, AStreamAllocatesNothing) {
  JointPoses poses(FakeArm(), {.samples = 16});
  std::vector<double> values = {0, 0};
  const testing::AllocationCounter counter;
  int known = 0;
  for (int64_t ms = 0; ms < 1000; ++ms) {
    values[0] = 0.001 * static_cast<double>(ms);
    if (!poses.Push(ms * kMs, values).ok()) return;
    known += poses.PoseAt(ms * kMs - kMs / 2).has_value();
    known += poses.PoseAt(ms * kMs + kMs / 2).has_value();
    poses.PoseAt(ms * kMs + 900 * kMs);
  }
  EXPECT_EQ(counter.count(), 0);
  // All but the first two, which have no samples around them.
  EXPECT_EQ(known, 1998);
}

// For ThreadSanitizer, and that no pose mixes two samples: the joints are equal
// in each.
TEST(JointPosesTest, OneThreadPushesWhileAnotherAsks) {
  JointPoses poses(FakeArm(), {.samples = 8});
  std::thread pusher([&] {
    for (int64_t ms = 0; ms < 20'000; ++ms) {
      const double value = std::sin(0.001 * static_cast<double>(ms));
      poses.Push(ms * kMs, std::vector<double>{value, value}).IgnoreError();
    }
  });
  for (int64_t ms = 0; ms < 20'000; ++ms) {
    const auto pose = poses.PoseAt(ms * kMs);
    poses.Problem();
    if (!pose) continue;
    EXPECT_NEAR(pose->position.x(), TurnOf(*pose), 1e-9);
  }
  pusher.join();
  EXPECT_TRUE(poses.PoseAt(19'999 * kMs));
}

}  // namespace
}  // namespace tactus::internal::client
