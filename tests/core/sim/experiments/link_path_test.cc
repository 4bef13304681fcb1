#include "core/sim/experiments/link_path.h"

#include "core/sim/skin/skin_model.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

// A contact during which the arm moves back at `speed` (m/s).
SimulatedContact MovingBack(double speed) {
  SimulatedContact contact;
  for (int i = 0; i < 200; ++i) {
    contact.signals.samples.push_back({1, 0.0016, -speed * (i + 1) / 100});
  }
  return contact;
}

TEST(LinkPathTest, FollowsEachContactAndTurnsSmoothly) {
  const SkinLayout layout = SkinModelNamed("good")->layout;
  const SimulatedContact first = MovingBack(0.02);
  const SimulatedContact second = MovingBack(0.1);
  const PlacedContact a = {.contact = &first,
                           .centre = {.row = 3, .column = 0},
                           .begin_frame = 10,
                           .end_sample = 91};
  const PlacedContact b = {.contact = &second,
                           .centre = {.row = 3, .column = 6},
                           .begin_frame = 126,
                           .end_sample = 75};
  LinkPath path(layout, a);
  path.Follow(100, 25, b);
  path.Rest(200, 50);
  const std::vector<LinkStep> steps = path.Steps(300);
  ASSERT_EQ(steps.size(), 300);
  const auto at = [&](size_t i) {
    return Eigen::Vector3d(steps[i].distance_m * steps[i].direction);
  };
  const Eigen::Vector3d along_a = LinkNormal(layout, a.centre);
  const Eigen::Vector3d along_b = LinkNormal(layout, b.centre);
  EXPECT_EQ(at(0).norm(), 0);
  EXPECT_NEAR(at(50).dot(along_a), -0.02 * 0.41, 1e-12);
  // After the turn, only along the second one's normal.
  EXPECT_NEAR((at(190) - at(130) + along_b * 0.06).norm(), 0, 1e-12);
  EXPECT_EQ(at(250), at(299));
  for (size_t i = 1; i < 299; ++i) {
    // Neither jumps nor jerks: both ways' speeds, and a turn within them.
    EXPECT_LT((at(i) - at(i - 1)).norm(), 0.0015) << i;
    if (i == 9 || i == 125) continue;  // the touches of these two
    EXPECT_LT((at(i + 1) - 2 * at(i) + at(i - 1)).norm(), 2e-4) << i;
  }
}

}  // namespace
}  // namespace tactus::internal
