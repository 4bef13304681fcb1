// LightTouchFilter has the bits of its definition, at every vector width.
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "core/light_touch/light_touch.h"
#include "gtest/gtest.h"
#include "tests/core/features/light_touch_reference.h"
#include "tests/support/flat_layout.h"
#include "tests/support/for_each_target.h"

namespace tactus::internal {
namespace {

// Skins of all sizes; regions of all sizes, most of them 3 x 3.
SkinLayout DrawLayout(Random& random) {
  const bool usual = random.Index(4) == 0;
  const int rows = usual ? 16 : static_cast<int>(1 + random.Index(24));
  const int columns = usual ? 24 : static_cast<int>(1 + random.Index(40));
  SkinLayout layout = testing::FlatLayout(rows, columns);
  layout.wrap_columns = random.Index(2) == 0;
  layout.contact_threshold = 0.3;
  layout.onset_threshold = 0.5;
  const bool square = random.Index(3) != 0;
  const auto side = [&](int most) {
    const int size = square ? 3 : static_cast<int>(1 + random.Index(16));
    return std::min(size, most);
  };
  layout.light_touch = LightTouch{.window_s = 0.1,
                                  .rows = side(rows),
                                  .columns = side(columns),
                                  .contact_threshold = 0.05,
                                  .onset_threshold = 0.08};
  if (random.Index(3) == 0) {
    layout.mask.assign(layout.taxels(), 1);
    for (uint8_t& taxel : layout.mask) taxel = random.Index(5) != 0;
    layout.mask[0] = 1;
  }
  return layout;
}

// Noise about offsets that wander; now and then another load on some taxels,
// light or strong, or a step of all offsets that is taken for a drift.
class Frames {
 public:
  // A load stays for `held` frames in the mean.
  Frames(const SkinLayout& layout, int held, Random& random)
      : random_(&random),
        layout_(layout),
        held_(held),
        load_(layout.taxels()) {}

  const std::vector<float>& Next() {
    if (random_->Index(held_) == 0) DrawLoad();
    if (random_->Index(200) == 0) offset_ = random_->Uniform(0, 0.4);
    offset_ += 0.0002;
    taxels_.clear();
    for (const double load : load_) {
      const double noise = noise_ * random_->Gaussian();
      taxels_.push_back(
          static_cast<float>(std::max(0.0, offset_ + load + noise)));
    }
    return taxels_;
  }

 private:
  void DrawLoad() {
    std::ranges::fill(load_, 0.0);
    // Too light for a single taxel, for once.
    const bool light = random_->Index(4) != 0;
    noise_ = random_->Uniform(0, light ? 0.02 : 0.1);
    if (random_->Index(4) == 0) return;
    const double force = std::exp(random_->Uniform(-3, light ? -1.5 : 3));
    const auto row = static_cast<int>(random_->Index(layout_.rows));
    const auto column = static_cast<int>(random_->Index(layout_.columns));
    const auto height = static_cast<int>(1 + random_->Index(6));
    const auto width = static_cast<int>(1 + random_->Index(6));
    for (int r = row; r < std::min(row + height, layout_.rows); ++r) {
      for (int c = column; c < column + width; ++c) {
        load_[r * layout_.columns + c % layout_.columns] = force;
      }
    }
  }

  Random* random_;
  const SkinLayout& layout_;
  int held_;
  std::vector<double> load_;
  double offset_ = 0.1;
  double noise_ = 0.01;
  std::vector<float> taxels_;
};

struct Seen {
  int shapes = 0;
  int lights = 0;
  int drifts = 0;
};

// With `skips` the filter leaves out rows, and only what is in them may differ.
void ExpectSame(const LightTouchFilter& filter,
                const LightTouchReference& reference, const SkinLayout& layout,
                bool skips) {
  const auto strong = static_cast<float>(layout.contact_threshold);
  const auto contact =
      static_cast<float>(layout.light_touch->contact_threshold);
  ASSERT_EQ(filter.peak(), reference.peak());
  ASSERT_EQ(filter.has_shape(), reference.has_shape());
  ASSERT_TRUE(std::ranges::equal(filter.shape(), reference.shape()));
  if (!skips) {
    ASSERT_EQ(filter.region_peak(), reference.region_peak());
    ASSERT_TRUE(std::ranges::equal(filter.regions(), reference.regions()));
    ASSERT_TRUE(std::ranges::equal(filter.values(), reference.values()));
    return;
  }
  if (reference.region_peak() >= contact) {
    ASSERT_EQ(filter.region_peak(), reference.region_peak());
  } else {
    ASSERT_LT(filter.region_peak(), contact);
  }
  for (int i = 0; i < layout.taxels(); ++i) {
    const float value = reference.values()[i];
    if (filter.values()[i] == value) continue;
    ASSERT_EQ(filter.values()[i], 0) << i;
    ASSERT_LT(value, strong) << i;
    ASSERT_EQ(filter.shape()[i], 0) << i;
  }
}

void Compare(uint64_t seed, int frame_count, Seen& seen) {
  Random random(seed);
  const SkinLayout layout = DrawLayout(random);
  ASSERT_TRUE(Validate(layout).ok());
  // At the lower rate 10 s are few frames.
  const bool slow = random.Index(2) == 0;
  const double rate = slow ? 4 : 100;
  LightTouchFilter full(layout, rate);
  LightTouchFilter skipping(layout, rate, /*skip_quiet_rows=*/true);
  LightTouchReference reference(layout, rate);
  Frames frames(layout, slow ? 100 : 20, random);
  for (int t = 0; t < frame_count; ++t) {
    SCOPED_TRACE(t);
    const std::vector<float>& taxels = frames.Next();
    full.Step(taxels);
    skipping.Step(taxels);
    reference.Step(taxels);
    ASSERT_NO_FATAL_FAILURE(ExpectSame(full, reference, layout, false));
    ASSERT_NO_FATAL_FAILURE(ExpectSame(skipping, reference, layout, true));
    seen.shapes += reference.has_shape();
    seen.lights +=
        reference.has_shape() &&
        reference.peak() < static_cast<float>(layout.contact_threshold);
    seen.drifts += reference.drifts();
  }
}

TEST(LightTouchBitsTest, TheFilterHasTheBitsOfItsDefinition) {
  ForEachTarget([] {
    Seen seen;
    for (uint64_t seed = 1; seed <= 24; ++seed) {
      SCOPED_TRACE(seed);
      ASSERT_NO_FATAL_FAILURE(Compare(seed, 250, seen));
    }
    EXPECT_GT(seen.shapes, 1'000);
    EXPECT_GT(seen.lights, 100);
    EXPECT_GT(seen.drifts, 10);
  });
}

}  // namespace
}  // namespace tactus::internal
