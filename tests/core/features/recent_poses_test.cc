#include "core/features/recent_poses.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "Eigen/QR"
#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

const Eigen::Vector3d kWayOutwards(0, 0.6, 0.8);

Pose PoseOf(const Eigen::Vector3d& position) {
  Pose pose;
  pose.position = position;
  return pose;
}

// What is left of the newest of `ways` (m along kWayOutwards) by the estimate.
double ErrorOfNewest(const std::vector<double>& ways, double rate = 100,
                     const Eigen::Vector3d& origin = {0, 0, 0}) {
  RecentPoses poses(rate);
  for (const double way : ways) {
    const Pose pose = PoseOf(origin + way * kWayOutwards);
    poses.Add(&pose, 0);
  }
  return poses.NewestError({0.1, -0.2, 0.3}, kWayOutwards);
}

TEST(RecentPosesTest, LessThanFourPosesAreAveraged) {
  EXPECT_EQ(ErrorOfNewest({}), 0);
  EXPECT_EQ(ErrorOfNewest({5}), 0);
  EXPECT_NEAR(ErrorOfNewest({1, 2}), 0.5, 1e-15);
  EXPECT_NEAR(ErrorOfNewest({1, 4, 7}), 3, 1e-15);
}

// Steady motion, also far from the origin, is no error of the newest pose.
TEST(RecentPosesTest, SteadyMotionIsNoError) {
  for (const double speed : {-0.08, 1e-6, 0.02, 3.0}) {
    std::vector<double> ways;
    for (int i = 0; i < 50; ++i) ways.push_back(speed * i / 100);
    EXPECT_NEAR(ErrorOfNewest(ways), 0, 1e-15);
    EXPECT_NEAR(ErrorOfNewest(ways, 100, {1e3, -1e3, 1e3}), 0, 1e-12);
  }
}

// The rule of NewestError() in linear algebra: polynomials of `degree` through
// the last `size` ways by QR decomposition, the newest at time 0.
std::pair<double, double> Fitted(const std::vector<double>& ways, int size,
                                 int degree) {
  Eigen::MatrixXd design(size, degree + 1);
  Eigen::VectorXd values(size);
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j <= degree; ++j) design(i, j) = std::pow(-i, j);
    values[i] = ways[ways.size() - 1 - i];
  }
  const Eigen::VectorXd fit = design.colPivHouseholderQr().solve(values);
  const Eigen::MatrixXd inverse = (design.transpose() * design).inverse();
  return {fit[0], inverse(0, 0)};
}

double ErrorByAlgebra(const std::vector<double>& ways, int* chosen) {
  const std::vector<std::pair<double, double>> estimates = {
      Fitted(ways, 20, 0), Fitted(ways, 20, 1), Fitted(ways, 10, 1),
      Fitted(ways, 5, 1), Fitted(ways, 1, 0)};
  double noise = 0;
  for (size_t i = 2; i < 20; ++i) {
    noise += std::pow(ways[i] - 2 * ways[i - 1] + ways[i - 2], 2) / 6 / 18;
  }
  for (*chosen = 0;; ++*chosen) {
    const auto& [value, variance] = estimates[*chosen];
    bool contradicted = false;
    for (size_t later = *chosen + 1; later < estimates.size(); ++later) {
      contradicted |=
          std::abs(estimates[later].first - value) >
          3 * std::sqrt(noise * (estimates[later].second - variance));
    }
    if (!contradicted) return ways.back() - value;
  }
}

// Ways that rest, go straight, start, and stop.
TEST(RecentPosesTest, TakesTheSmoothestEstimateThatAgrees) {
  Random random(1);
  std::vector<int> chosen(5);
  for (int run = 0; run < 2000; ++run) {
    const double speed = std::exp(random.Uniform(-3, 5));
    const double turn = random.Uniform(0, 40);
    std::vector<double> ways;
    for (int i = 0; i < 20; ++i) {
      const double moving = run % 2 == 0 ? std::min<double>(i, turn)
                                         : std::max<double>(i - turn, 0);
      ways.push_back(speed * moving + random.Gaussian());
    }
    int choice = 0;
    const double expected = ErrorByAlgebra(ways, &choice);
    ASSERT_NEAR(ErrorOfNewest(ways), expected, 1e-9) << speed << " " << turn;
    ++chosen[choice];
  }
  for (int i = 0; i < 5; ++i) EXPECT_GT(chosen[i], 20) << i;
}

// The root mean square of what is left of a pose's error of 1, for a link that
// moves at `speed` a frame until `stop` frames before the newest.
double LeftOfError(double rate, double speed, int stop) {
  Random random(2);
  double left = 0;
  constexpr int kRuns = 4000;
  for (int run = 0; run < kRuns; ++run) {
    std::vector<double> ways;
    for (int i = 0; i < rate; ++i) {
      ways.push_back(speed * std::min(i - rate + 1 + stop, 0.0) +
                     random.Gaussian());
    }
    const double rest = ways.back() - ErrorOfNewest(ways, rate);
    left += rest * rest / kRuns;
  }
  return std::sqrt(left);
}

// 1 is a single pose, 0.22 the mean of twenty, 0.43 their line.
TEST(RecentPosesTest, NoiseAveragesOut) {
  for (const double rate : {100.0, 150.0, 1000.0}) {
    EXPECT_LT(LeftOfError(rate, 0, 0), 0.35) << rate;
    EXPECT_GT(LeftOfError(rate, 0, 0), 0.22) << rate;
    EXPECT_LT(LeftOfError(rate, 20, 0), 0.6) << rate;
  }
  // A link that has just stopped: what went before says nothing.
  for (const int stop : {2, 5, 12}) {
    EXPECT_LT(LeftOfError(100, 20, stop), 1.2) << stop;
  }
}

TEST(RecentPosesTest, FramesWithoutPosesTakeTime) {
  RecentPoses poses(100);
  int frame = 0;
  for (const int step : {1, 3, 1, 1, 5, 2}) {
    for (int i = 1; i < step && step != 5; ++i) poses.Add(nullptr, 0);
    frame += step;
    const Pose pose = PoseOf(0.01 * frame * kWayOutwards);
    poses.Add(&pose, step == 5 ? 4 : 0);
  }
  EXPECT_NEAR(poses.NewestError({0, 0, 0}, kWayOutwards), 0, 1e-15);
}

TEST(RecentPosesTest, OnlyTheLastFifthOfASecondCounts) {
  const Pose away = PoseOf({0, 0, 9});
  const Pose here = PoseOf({0, 0, 1});
  struct Case {
    // Poses here after those away, and frames lost between.
    int poses;
    uint64_t missing;
    bool forgotten;
  };
  constexpr uint64_t kHuge = std::numeric_limits<uint64_t>::max();
  for (const Case& c :
       {Case{20, 0, true}, Case{19, 0, false}, Case{1, 19, true},
        Case{1, 18, false}, Case{1, kHuge, true}, Case{10, 10, true}}) {
    RecentPoses poses(100);
    for (int i = 0; i < 30; ++i) poses.Add(&away, 0);
    for (int i = 0; i < c.poses; ++i) poses.Add(&here, i == 0 ? c.missing : 0);
    const double error = poses.NewestError({0, 0, 0}, {0, 0, 1});
    EXPECT_EQ(error == 0, c.forgotten) << c.poses << " " << c.missing;
  }
}

// An arm that turns puts its end where the end's own poses are.
TEST(RecentPosesTest, OrientationMovesThePlace) {
  RecentPoses arm(100);
  RecentPoses end(100);
  const Eigen::Vector3d place(2, 0.5, 0);
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    Pose pose;
    pose.position = {0, 0, 0.01 * i};
    pose.orientation = Eigen::AngleAxisd(0.01 * i + 0.001 * random.Gaussian(),
                                         Eigen::Vector3d(0, 0.8, -0.6));
    arm.Add(&pose, 0);
    const Pose of_end = PoseOf(pose.position + pose.orientation * place);
    end.Add(&of_end, 0);
  }
  const double error = arm.NewestError(place, kWayOutwards);
  EXPECT_GT(std::abs(error), 1e-5);
  EXPECT_NEAR(error, end.NewestError({0, 0, 0}, kWayOutwards), 1e-12);
}

TEST(RecentPosesTest, ResetForgets) {
  RecentPoses poses(100);
  const Pose away = PoseOf({0, 0, 9});
  const Pose here = PoseOf({0, 0, 1});
  poses.Add(&away, 0);
  poses.Reset();
  poses.Add(&here, 0);
  EXPECT_EQ(poses.NewestError({0, 0, 0}, {0, 0, 1}), 0);
}

// Ten million frames at 1 km from the origin are as good as ten.
TEST(RecentPosesTest, LongStreamsLoseNoDigits) {
  RecentPoses poses(100);
  Pose pose;
  for (int i = 0; i < 10'000'000; ++i) {
    pose.position = {1e3, -1e3, 1e3 + 1e-5 * (i % 1000)};
    poses.Add(&pose, i % 3 == 0 ? 1 : 0);
  }
  // The last poses are 990 to 999 steps away, in frames of 1, 1 and 2.
  RecentPoses few(100);
  for (int i = 10'000'000 - 20; i < 10'000'000; ++i) {
    pose.position = {0, 0, 1e-5 * (i % 1000)};
    few.Add(&pose, i % 3 == 0 ? 1 : 0);
  }
  EXPECT_NEAR(poses.NewestError({1, 2, 3}, {0, 0, 1}),
              few.NewestError({1, 2, 3}, {0, 0, 1}), 2e-12);
}

// A client that replays frames from a kept pose on, older than the window, gets
// the bits of the whole stream; from most other poses on it would not.
TEST(RecentPosesTest, AReplayFromAKeptPoseIsEqual) {
  int unequal = 0;
  for (const double rate : {30.0, 100.0, 1000.0, 1490.0}) {
    Random random(7);
    constexpr int kFrames = 3000;
    std::vector<Pose> poses;
    std::vector<uint64_t> missing;
    for (int t = 0; t < kFrames; ++t) {
      const double way = 1e-4 * t + 1e-5 * random.Gaussian();
      poses.push_back(PoseOf(way * kWayOutwards));
      missing.push_back(t % 37 == 0 ? t % 5 : 0);
    }
    const auto replay = [&](int begin) {
      RecentPoses recent(rate);
      for (int t = begin; t < kFrames; ++t) {
        recent.Add(&poses[t], t == begin ? 0 : missing[t]);
      }
      return recent.NewestError({0.1, -0.2, 0.3}, kWayOutwards);
    };
    const double whole = replay(0);
    PoseSpacing spacing(rate);
    for (int t = 0; t < kFrames; ++t) {
      spacing.Step(missing[t]);
      const bool kept = spacing.Keep();
      if (t % 97 != 0 && t % 100 != 0) continue;
      if (t + static_cast<int>(spacing.window()) >= kFrames) break;
      if (kept) {
        EXPECT_EQ(replay(t), whole) << rate << " Hz, from frame " << t;
      } else {
        unequal += replay(t) != whole;
      }
    }
  }
  EXPECT_GT(unequal, 10);
}

}  // namespace
}  // namespace tactus::internal
