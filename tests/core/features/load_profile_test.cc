#include "core/features/load_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/random.h"
#include "core/features/contact_tracker.h"
#include "gtest/gtest.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/flat_layout.h"

namespace tactus::internal {
namespace {

using testing::FlatLayout;

// By definition, a line belongs to the band whose range contains it.
int BandOf(int line, int lines, int bands) {
  const int k = std::min(lines, bands);
  for (int i = 0; i < k; ++i) {
    if (i * lines / k <= line && line < (i + 1) * lines / k) return i;
  }
  return -1;
}

// Taxel by taxel, without regions or rows.
LoadProfile Reference(const SkinLayout& layout,
                      const std::vector<float>& taxels) {
  std::vector<long double> loads(kProfileSize);
  for (int i = 0; i < layout.taxels(); ++i) {
    const bool valid = layout.mask.empty() || layout.mask[i] != 0;
    if (!valid || !(taxels[i] >= layout.contact_threshold)) continue;
    loads[BandOf(i / layout.columns, layout.rows, kRowBands)] += taxels[i];
    loads[kRowBands + BandOf(i % layout.columns, layout.columns,
                             kColumnBands)] += taxels[i];
  }
  LoadProfile profile;
  for (int i = 0; i < kProfileSize; ++i) {
    profile[i] = static_cast<double>(std::sqrt(loads[i]));
  }
  return profile;
}

void ExpectNear(const LoadProfile& got, const LoadProfile& want) {
  for (int i = 0; i < kProfileSize; ++i) {
    EXPECT_NEAR(got[i], want[i], 1e-12 * want[i]) << "band " << i;
  }
}

TEST(LoadProfileTest, AgreesWithAPlainLoopOnRandomSkins) {
  Random random(11);
  for (int trial = 0; trial < 300; ++trial) {
    SkinLayout layout = FlatLayout(1 + static_cast<int>(random.Index(64)),
                                   1 + static_cast<int>(random.Index(64)));
    layout.wrap_columns = random.Index(2) == 0;
    if (random.Index(2) == 0) {
      layout.mask.resize(layout.taxels());
      for (uint8_t& valid : layout.mask) valid = random.Index(5) != 0;
    }
    ContactTracker tracker(layout, {});
    std::vector<float> taxels(layout.taxels());
    // The first frame must not change the result of the second.
    for (int frame = 0; frame < 2; ++frame) {
      const double density = random.Uniform();
      for (float& taxel : taxels) {
        const double size = random.Uniform() < density ? 40 : 1.2;
        taxel = static_cast<float>(size * random.Uniform());
      }
      taxels[random.Index(taxels.size())] =
          std::numeric_limits<float>::quiet_NaN();
      const FrameFeatures& features = tracker.Step({taxels});
      if (tracker.state() != ContactState::kInContact) continue;
      ExpectNear(features.profile, Reference(layout, taxels));
      EXPECT_EQ(features.sample().profile, features.profile);
    }
  }
}

TEST(LoadProfileTest, ASkinOfFewLinesLeavesBandsEmpty) {
  const double rows[] = {4, 9};
  const double columns[] = {1, 0, 16};
  LoadProfile want = {};
  want[0] = 2;
  want[1] = 3;
  want[kRowBands] = 1;
  want[kRowBands + 2] = 4;
  EXPECT_EQ(MakeLoadProfile(rows, columns), want);
}

TEST(LoadProfileTest, AllRegionsCount) {
  const SkinLayout layout = FlatLayout(6, 10);
  ContactTracker tracker(layout, {});
  std::vector<float> taxels(layout.taxels());
  taxels[0] = taxels[1] = 2;
  taxels[59] = 9;
  const FrameFeatures& features = tracker.Step({taxels});
  EXPECT_EQ(features.region_count, 2);
  EXPECT_EQ(features.profile[0], 2);
  EXPECT_EQ(features.profile[5], 3);
  EXPECT_EQ(features.profile[kProfileSize - 1], 3);
}

TEST(LoadProfileTest, ZeroOutsideTouchAndNothingIsAllocated) {
  const SkinLayout layout = *LayoutPreset("icub-6x10");
  ContactTracker tracker(layout, {.sample_rate_hz = 50, .release_after_s = 1});
  const std::vector<float> touched(layout.taxels(), 10);
  const std::vector<float> weak(layout.taxels(), 4.5F);
  const std::vector<float> none(layout.taxels());
  const testing::AllocationCounter allocations;
  // Touched, but no contact yet.
  EXPECT_EQ(tracker.Step({weak}).profile, LoadProfile{});
  EXPECT_EQ(tracker.Step({touched}).profile[0], 10);
  EXPECT_EQ(tracker.Step({none}).profile, LoadProfile{});
  EXPECT_EQ(tracker.state(), ContactState::kInContact);
  EXPECT_EQ(tracker.Step({touched}).profile[kProfileSize - 1], std::sqrt(60));
  EXPECT_EQ(allocations.count(), 0);
}

}  // namespace
}  // namespace tactus::internal
