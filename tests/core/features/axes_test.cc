// A skin of three axes gives the contacts of its loads, and their shear.
#include <algorithm>
#include <vector>

#include "core/base/random.h"
#include "core/features/skin_tracker.h"
#include "gtest/gtest.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/flat_layout.h"

namespace tactus::internal {
namespace {

constexpr int kRows = 6;
constexpr int kColumns = 9;

SkinLayout ThreeAxes(int normal) {
  SkinLayout layout = testing::FlatLayout(kRows, kColumns);
  layout.axes = 3;
  layout.normal_axis = normal;
  layout.signed_values = true;
  return layout;
}

// Presses that come, wander and go, with shear everywhere and loads below 0 on
// untouched taxels.
std::vector<std::vector<float>> FramesOfAxes(int normal) {
  Random random(11);
  std::vector<std::vector<float>> frames;
  for (int t = 0; t < 400; ++t) {
    std::vector<float> values(3 * kRows * kColumns);
    for (float& value : values) {
      value = static_cast<float>(random.Gaussian());
    }
    for (int taxel = 0; taxel < kRows * kColumns; ++taxel) {
      const int row = taxel / kColumns - (t / 50) % 4;
      const int column = taxel % kColumns - (t / 20) % 6;
      const bool pressed =
          t % 90 < 60 && (row == 0 || row == 1) && column >= 0 && column < 3;
      values[3 * taxel + normal] = pressed ? 3 + random.Uniform() : -0.5F;
    }
    frames.push_back(values);
    // The same once more.
    if (t % 7 == 0) frames.push_back(values);
  }
  return frames;
}

TEST(AxesTest, ContactsAreThoseOfTheLoads) {
  for (const int normal : {0, 1, 2}) {
    const SkinLayout layout = ThreeAxes(normal);
    SkinLayout line = layout;
    line.axes = 1;
    line.normal_axis.reset();
    line.signed_values = false;
    SkinTracker axes(layout, {.max_contacts = 8,
                              .taxel_loads = true,
                              .load_spread = true,
                              .shear = true});
    SkinTracker loads(line, {.max_contacts = 8,
                             .taxel_loads = true,
                             .load_spread = true,
                             .shear = true});
    int touched = 0;
    for (const std::vector<float>& values : FramesOfAxes(normal)) {
      std::vector<float> pressed(line.taxels());
      for (size_t i = 0; i < pressed.size(); ++i) {
        pressed[i] = std::max(values[3 * i + normal], 0.0F);
      }
      const testing::AllocationCounter counter;
      axes.Step({.taxels = values});
      // The first contact in a place of the tracker makes its memory.
      if (axes.contacts_begun() > 1) {
        EXPECT_EQ(counter.count(), 0);
      }
      loads.Step({.taxels = pressed});
      ASSERT_EQ(axes.contacts().size(), loads.contacts().size());
      for (size_t c = 0; c < axes.contacts().size(); ++c) {
        const TrackedContact& got = *axes.contacts()[c];
        const TrackedContact& want = *loads.contacts()[c];
        ASSERT_EQ(got.id(), want.id());
        ASSERT_EQ(got.phase, want.phase);
        const ContactSample sample = got.features().sample();
        const ContactSample same = want.features().sample();
        ASSERT_EQ(sample.features, same.features);
        ASSERT_EQ(sample.net_force, same.net_force);
        ASSERT_EQ(sample.profile, same.profile);
        ASSERT_EQ(sample.spread, same.spread);
        ASSERT_EQ(same.shear, Shear());
        ASSERT_TRUE(std::ranges::equal(sample.loads, same.loads));
        if (!got.features().touched) {
          EXPECT_EQ(sample.shear, Shear());
          continue;
        }
        ++touched;
        // By a loop over the region's taxels.
        double sums[3] = {};
        const std::span<const uint64_t> rows = axes.RowsOf(got.slot);
        for (int taxel = 0; taxel < layout.taxels(); ++taxel) {
          if ((rows[taxel / kColumns] >> (taxel % kColumns) & 1) == 0) continue;
          for (int axis = 0; axis < 3; ++axis) {
            sums[axis] += values[3 * taxel + axis];
          }
        }
        EXPECT_NEAR(sums[normal], sample.net_force, 1e-4);
        EXPECT_NEAR(sample.shear.first, sums[normal == 0 ? 1 : 0], 1e-5);
        EXPECT_NEAR(sample.shear.second, sums[normal == 2 ? 1 : 2], 1e-5);
      }
    }
    EXPECT_GT(touched, 200);
  }
}

}  // namespace
}  // namespace tactus::internal
