#include "core/skin/layout.h"

#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "core/skin/geometry.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(LayoutPresetTest, PresetsAreValid) {
  const std::pair<const char*, int> presets[] = {
      {"cody-forearm", 384}, {"vitac-12x32", 384}, {"icub-6x10", 60}};
  for (const auto& [name, taxels] : presets) {
    auto layout = LayoutPreset(name);
    ASSERT_TRUE(layout.ok()) << name;
    EXPECT_EQ(layout->name, name);
    EXPECT_TRUE(Validate(*layout).ok()) << name;
    EXPECT_EQ(layout->taxels(), taxels) << name;
  }
}

TEST(LayoutPresetTest, UnknownNameIsRefusedWithReason) {
  auto layout = LayoutPreset("moon");
  EXPECT_EQ(layout.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(ReasonOf(layout.status()), "UNKNOWN_LAYOUT");
  EXPECT_EQ(layout.status().message(),
            "layout \"moon\" is not a preset (cody-forearm, vitac-12x32, "
            "icub-6x10); describe it in full, with rows and columns");
}

// The paper's forearm: radius 46.04 mm (shared geometry of the Meka skin).
TEST(LayoutPresetTest, CodyForearmIsTheMekaCylinder) {
  auto layout = LayoutPreset("cody-forearm");
  ASSERT_TRUE(layout.ok());
  EXPECT_NEAR(layout->CylinderRadius(), 0.04604, 1e-12);
  EXPECT_TRUE(layout->wrap_columns);
}

TEST(ValidateTest, EachBadFieldIsNamed) {
  SkinLayout good = *LayoutPreset("cody-forearm");
  struct Case {
    const char* field;
    void (*spoil)(SkinLayout&);
  };
  const Case cases[] = {
      {"geometry.rows", [](SkinLayout& l) { l.rows = 65; }},
      {"geometry.columns", [](SkinLayout& l) { l.columns = 0; }},
      {"geometry.row_pitch_m", [](SkinLayout& l) { l.row_pitch_m = -1; }},
      {"geometry.column_pitch_m",
       [](SkinLayout& l) { l.column_pitch_m = std::nan(""); }},
      {"geometry.taxel_area_m2", [](SkinLayout& l) { l.taxel_area_m2 = 0; }},
      {"geometry.contact_threshold",
       [](SkinLayout& l) { l.contact_threshold = 0; }},
      {"geometry.onset_threshold",
       [](SkinLayout& l) { l.onset_threshold = l.contact_threshold / 2; }},
      {"geometry.mask size", [](SkinLayout& l) { l.mask.resize(3); }},
      {"geometry.light_touch.window_s",
       [](SkinLayout& l) { l.light_touch->window_s = 0.009; }},
      {"geometry.light_touch.window_s",
       [](SkinLayout& l) { l.light_touch->window_s = std::nan(""); }},
      {"geometry.light_touch.rows",
       [](SkinLayout& l) { l.light_touch->rows = 0; }},
      {"geometry.light_touch.rows",
       [](SkinLayout& l) { l.light_touch->rows = 17; }},
      {"geometry.light_touch.columns",
       [](SkinLayout& l) { l.light_touch->columns = l.columns + 1; }},
      {"geometry.light_touch.contact_threshold",
       [](SkinLayout& l) { l.light_touch->contact_threshold = 0; }},
      {"geometry.light_touch.onset_threshold",
       [](SkinLayout& l) { l.light_touch->onset_threshold = 0.001; }},
  };
  good.light_touch = LightTouch{0.1, 3, 3, 0.002, 0.003};
  ASSERT_TRUE(Validate(good).ok());
  for (const Case& c : cases) {
    SkinLayout layout = good;
    c.spoil(layout);
    const absl::Status status = Validate(layout);
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << c.field;
    EXPECT_EQ(InfoOf(status).metadata().at("field"), c.field);
  }
}

TEST(SkinDistanceTest, GoesTheShortWayRoundACylinder) {
  const SkinLayout layout = *LayoutPreset("cody-forearm");
  EXPECT_NEAR(SkinDistance(layout, {3, 0}, {3, 23}), layout.column_pitch_m,
              1e-12);
  EXPECT_NEAR(SkinDistance(layout, {3, 0.5}, {5, 0.5}), 2 * layout.row_pitch_m,
              1e-12);
}

TEST(LinkPositionTest, WrappedColumnsLieOnTheCylinder) {
  const SkinLayout layout = *LayoutPreset("cody-forearm");
  const Eigen::Vector3d a = LinkPosition(layout, {2, 6});
  EXPECT_NEAR(a.x(), 0, 1e-12);
  EXPECT_NEAR(a.y(), 0.04604, 1e-12);
  EXPECT_NEAR(a.z(), 2 * 0.0108, 1e-12);
  EXPECT_NEAR((a - LinkPosition(layout, {2, 30})).norm(), 0, 1e-12);
}

// Whatever changes what a frame means is named; a broken taxel is not.
TEST(SkinDifferenceTest, NamesTheFirstDifference) {
  const SkinLayout base = *LayoutPreset("icub-6x10");
  EXPECT_EQ(SkinDifference(base, base), "");
  const std::pair<const char*, void (*)(SkinLayout&)> cases[] = {
      {"layout other, not icub-6x10", [](SkinLayout& s) { s.name = "other"; }},
      {"shape 5x10, not 6x10", [](SkinLayout& s) { s.rows = 5; }},
      {"shape 6x10 with wrapped columns, not 6x10",
       [](SkinLayout& s) { s.wrap_columns = true; }},
      {"unit newton, not counts",
       [](SkinLayout& s) { s.unit = TaxelUnit::kNewton; }},
      {"contact_threshold 4.5, not 4",
       [](SkinLayout& s) { s.contact_threshold = 4.5; }},
      {"onset_threshold 6, not 5",
       [](SkinLayout& s) { s.onset_threshold = 6; }},
      {"row_pitch_m 0.027, not 0.026",
       [](SkinLayout& s) { s.row_pitch_m = 0.027; }},
      {"connectivity 4, not 8",
       [](SkinLayout& s) { s.connectivity = Connectivity::kFour; }},
      {"light_touch 0.1 s 3x2 0.5 0.75, not off",
       [](SkinLayout& s) {
         s.light_touch = LightTouch{0.1, 3, 2, 0.5, 0.75};
       }},
  };
  for (const auto& [text, change] : cases) {
    SkinLayout other = base;
    change(other);
    EXPECT_EQ(SkinDifference(other, base), text);
  }
  // Six digits of both are equal.
  SkinLayout close = base;
  close.contact_threshold = 4.00000001;
  EXPECT_EQ(SkinDifference(close, base), "contact_threshold 4.00000001, not 4");
  SkinLayout broken = base;
  broken.mask.assign(60, 1);
  broken.mask[7] = 0;
  broken.row_pitch_m *= 1 + 1e-9;
  EXPECT_EQ(SkinDifference(broken, base), "");
}

}  // namespace
}  // namespace tactus::internal
