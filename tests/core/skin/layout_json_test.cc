#include "core/skin/layout_json.h"

#include "core/base/errors.h"
#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(LayoutJsonTest, EveryBitComesBack) {
  for (uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed);
    SkinLayout layout;
    layout.name = "skin \"" + std::to_string(seed) + "\"";
    layout.rows = 1 + static_cast<int>(random.Index(64));
    layout.columns = 1 + static_cast<int>(random.Index(64));
    layout.row_pitch_m = random.Uniform(1e-6, 1);
    layout.column_pitch_m = random.Uniform(1e-6, 1);
    layout.taxel_area_m2 = random.Uniform(1e-12, 1);
    layout.wrap_columns = random.Index(2) == 0;
    layout.unit =
        random.Index(2) == 0 ? TaxelUnit::kCounts : TaxelUnit::kNewton;
    layout.contact_threshold = random.Uniform(1e-30, 1e6);
    layout.onset_threshold = 3 * layout.contact_threshold;
    layout.connectivity =
        random.Index(2) == 0 ? Connectivity::kFour : Connectivity::kEight;
    if (layout.taxels() > 2) {
      layout.mask.assign(layout.taxels(), 1);
      layout.mask[random.Index(layout.taxels())] = 0;
    }
    if (seed % 2 == 0) {
      const double contact = random.Uniform(1e-9, 1);
      layout.light_touch =
          LightTouch{random.Uniform(0.01, 1), 1, 1, contact, 2 * contact};
    }
    const auto again = LayoutFromJson(LayoutToJson(layout));
    ASSERT_TRUE(again.ok()) << again.status();
    EXPECT_EQ(*again, layout);
  }
}

TEST(LayoutJsonTest, APresetMayBeNamed) {
  EXPECT_EQ(*LayoutFromJson(R"({"layout": "icub-6x10"})"),
            *LayoutPreset("icub-6x10"));
  EXPECT_EQ(ReasonOf(LayoutFromJson("{").status()), "INVALID_CONFIG");
  EXPECT_EQ(ReasonOf(LayoutFromJson(R"({"layout": "x"})").status()),
            "UNKNOWN_LAYOUT");
}

}  // namespace
}  // namespace tactus::internal
