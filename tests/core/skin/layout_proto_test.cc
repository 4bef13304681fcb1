#include "core/skin/layout_proto.h"

#include "core/base/errors.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(LayoutFromProtoTest, ANameAloneIsAPreset) {
  v1::SensorGeometry geometry;
  geometry.set_layout("vitac-12x32");
  auto layout = LayoutFromProto(geometry);
  ASSERT_TRUE(layout.ok());
  EXPECT_EQ(layout->rows, 12);
  EXPECT_EQ(layout->unit, TaxelUnit::kCounts);
}

TEST(LayoutFromProtoTest, ThresholdsAndMaskRefineAPreset) {
  v1::SensorGeometry geometry;
  geometry.set_layout("cody-forearm");
  // The paper's threshold under the protective cover.
  geometry.set_contact_threshold(0.1);
  geometry.add_masked_taxels(383);
  auto layout = LayoutFromProto(geometry);
  ASSERT_TRUE(layout.ok()) << layout.status();
  EXPECT_EQ(layout->contact_threshold, 0.1);
  EXPECT_EQ(layout->onset_threshold, 0.1);
  EXPECT_EQ(layout->mask[383], 0);
  EXPECT_EQ(layout->mask[0], 1);
}

TEST(LayoutFromProtoTest, RoundTripKeepsEveryField) {
  SkinLayout layout = *LayoutPreset("cody-forearm");
  layout.name = "mine";
  layout.rows = 7;
  layout.columns = 9;
  layout.connectivity = Connectivity::kFour;
  layout.mask.assign(63, 1);
  layout.mask[5] = 0;
  layout.light_touch = LightTouch{.window_s = 0.15,
                                  .rows = 5,
                                  .columns = 3,
                                  .contact_threshold = 0.001,
                                  .onset_threshold = 0.002};
  auto back = LayoutFromProto(LayoutToProto(layout));
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->name, "mine");
  EXPECT_EQ(back->rows, 7);
  EXPECT_EQ(back->columns, 9);
  EXPECT_EQ(back->row_pitch_m, layout.row_pitch_m);
  EXPECT_EQ(back->column_pitch_m, layout.column_pitch_m);
  EXPECT_EQ(back->taxel_area_m2, layout.taxel_area_m2);
  EXPECT_EQ(back->wrap_columns, true);
  EXPECT_EQ(back->contact_threshold, layout.contact_threshold);
  EXPECT_EQ(back->onset_threshold, layout.onset_threshold);
  EXPECT_EQ(back->connectivity, Connectivity::kFour);
  EXPECT_EQ(back->mask, layout.mask);
  EXPECT_EQ(back->light_touch, layout.light_touch);
  EXPECT_EQ(*back, layout);
}

v1::SensorGeometry ThreeAxes() {
  SkinLayout layout = *LayoutPreset("cody-forearm");
  layout.name = "mine";
  layout.axes = 3;
  layout.normal_axis = 2;
  layout.signed_values = true;
  return LayoutToProto(layout);
}

TEST(LayoutFromProtoTest, RoundTripKeepsAxes) {
  auto layout = LayoutFromProto(ThreeAxes());
  ASSERT_TRUE(layout.ok()) << layout.status();
  EXPECT_EQ(layout->axes, 3);
  EXPECT_EQ(layout->normal_axis, 2);
  EXPECT_TRUE(layout->signed_values);
  EXPECT_EQ(layout->taxels(), 16 * 24);
  EXPECT_EQ(layout->values(), 3 * 16 * 24);
  EXPECT_EQ(*LayoutFromProto(LayoutToProto(*layout)), *layout);
  layout->normal_axis.reset();
  EXPECT_EQ(*LayoutFromProto(LayoutToProto(*layout)), *layout);
}

TEST(LayoutFromProtoTest, WithoutAxesASkinHasOneAxisAndNoSign) {
  const SkinLayout preset = *LayoutPreset("cody-forearm");
  EXPECT_EQ(preset.axes, 1);
  EXPECT_FALSE(preset.normal_axis);
  EXPECT_FALSE(preset.signed_values);
  // The same bytes as before there were axes.
  const v1::SensorGeometry geometry = LayoutToProto(preset);
  EXPECT_EQ(geometry.axes(), 0U);
  EXPECT_FALSE(geometry.has_normal_axis());
  EXPECT_FALSE(geometry.signed_values());
}

TEST(LayoutFromProtoTest, RefusesWrongAxes) {
  for (const uint32_t axes : {2U, 4U, 4'000'000'000U}) {
    v1::SensorGeometry geometry = ThreeAxes();
    geometry.set_axes(axes);
    geometry.clear_normal_axis();
    const absl::Status status = LayoutFromProto(geometry).status();
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
    EXPECT_NE(status.message().find("geometry.axes"), std::string::npos);
  }
  for (const uint32_t normal : {3U, 4'000'000'000U}) {
    v1::SensorGeometry geometry = ThreeAxes();
    geometry.set_normal_axis(normal);
    const absl::Status status = LayoutFromProto(geometry).status();
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
    EXPECT_NE(status.message().find("geometry.normal_axis"), std::string::npos);
  }
  v1::SensorGeometry line = ThreeAxes();
  line.clear_axes();
  EXPECT_EQ(ReasonOf(LayoutFromProto(line).status()), "INVALID_CONFIG");
  // A preset has its own.
  v1::SensorGeometry preset;
  preset.set_layout("cody-forearm");
  preset.set_axes(3);
  EXPECT_EQ(ReasonOf(LayoutFromProto(preset).status()), "INVALID_CONFIG");
}

TEST(LayoutFromProtoTest, SkinsOfOtherAxesDiffer) {
  const SkinLayout three = *LayoutFromProto(ThreeAxes());
  SkinLayout one = three;
  one.axes = 1;
  one.normal_axis.reset();
  EXPECT_EQ(SkinDifference(one, three),
            "axes 1, signed, not 3, signed, normal 2");
}

TEST(LayoutFromProtoTest, EachValueOfAMaskedTaxelIsMasked) {
  SkinLayout layout = *LayoutFromProto(ThreeAxes());
  EXPECT_TRUE(ValueMask(layout).empty());
  layout.mask.assign(layout.taxels(), 1);
  layout.mask[1] = 0;
  const std::vector<uint8_t> mask = ValueMask(layout);
  ASSERT_EQ(mask.size(), 3U * 16 * 24);
  for (size_t i = 0; i < mask.size(); ++i) EXPECT_EQ(mask[i] == 0, i / 3 == 1);
}

TEST(LayoutFromProtoTest, LightTouchIsOffUnlessGiven) {
  v1::SensorGeometry geometry;
  geometry.set_layout("cody-forearm");
  EXPECT_EQ(LayoutFromProto(geometry)->light_touch, std::nullopt);
  v1::LightTouch& light = *geometry.mutable_light_touch();
  light.set_window_s(0.1);
  light.set_rows(3);
  light.set_columns(3);
  light.set_contact_threshold(0.001);
  light.set_onset_threshold(0.002);
  EXPECT_EQ(LayoutFromProto(geometry)->light_touch,
            (LightTouch{0.1, 3, 3, 0.001, 0.002}));
  light.set_rows(4'000'000'000);
  EXPECT_EQ(ReasonOf(LayoutFromProto(geometry).status()), "INVALID_CONFIG");
  // Given, but without numbers.
  geometry.mutable_light_touch()->Clear();
  EXPECT_EQ(ReasonOf(LayoutFromProto(geometry).status()), "INVALID_CONFIG");
}

TEST(LayoutFromProtoTest, AuxiliaryTaxelsAreMaskedButTheirValuesCount) {
  v1::SensorGeometry geometry = LayoutToProto(*LayoutPreset("cody-forearm"));
  geometry.add_masked_taxels(2);
  geometry.add_auxiliary_taxels(9);
  geometry.add_auxiliary_taxels(4);
  const auto layout = LayoutFromProto(geometry);
  ASSERT_TRUE(layout.ok()) << layout.status();
  EXPECT_EQ(layout->auxiliary, (std::vector<uint32_t>{4, 9}));
  EXPECT_EQ(std::count(layout->mask.begin(), layout->mask.end(), 0), 3);
  const std::vector<uint8_t> values = ValueMask(*layout);
  EXPECT_EQ(std::count(values.begin(), values.end(), 0), 1);
  EXPECT_EQ(values[2], 0);
  // The way back, and once more.
  EXPECT_EQ(*LayoutFromProto(LayoutToProto(*layout)), *layout);
  EXPECT_EQ(LayoutToProto(*layout).masked_taxels_size(), 1);
  geometry.clear_auxiliary_taxels();
  EXPECT_EQ(SkinDifference(*layout, *LayoutFromProto(geometry)),
            "auxiliary_taxels 4 9, not none");
}

TEST(LayoutFromProtoTest, BadGeometriesAreRefusedWithReason) {
  struct Case {
    const char* reason;
    void (*spoil)(v1::SensorGeometry&);
  };
  const Case cases[] = {
      {"UNKNOWN_LAYOUT",
       [](v1::SensorGeometry& g) {
         g.Clear();
         g.set_layout("moon");
       }},
      {"INVALID_CONFIG", [](v1::SensorGeometry& g) { g.Clear(); }},
      // A preset with half a shape.
      {"INVALID_CONFIG",
       [](v1::SensorGeometry& g) {
         g.clear_rows();
         g.clear_columns();
       }},
      {"INVALID_CONFIG",
       [](v1::SensorGeometry& g) {
         for (int i = 0; i < 384; ++i) g.add_masked_taxels(i);
       }},
      {"INVALID_CONFIG", [](v1::SensorGeometry& g) { g.set_rows(65); }},
      {"INVALID_CONFIG",
       [](v1::SensorGeometry& g) { g.set_columns(4294967295U); }},
      {"INVALID_CONFIG", [](v1::SensorGeometry& g) { g.set_rows(0); }},
      {"INVALID_CONFIG", [](v1::SensorGeometry& g) { g.clear_unit(); }},
      {"INVALID_CONFIG",
       [](v1::SensorGeometry& g) { g.add_masked_taxels(384); }},
      {"INVALID_CONFIG",
       [](v1::SensorGeometry& g) { g.set_contact_threshold(-1); }},
      {"INVALID_CONFIG",
       [](v1::SensorGeometry& g) { g.add_auxiliary_taxels(384); }},
      {"INVALID_CONFIG",
       [](v1::SensorGeometry& g) {
         for (int i = 0; i < 2; ++i) g.add_auxiliary_taxels(7);
       }},
      {"INVALID_CONFIG",
       [](v1::SensorGeometry& g) {
         for (int i = 0; i < 65; ++i) g.add_auxiliary_taxels(i);
       }},
      {"INVALID_CONFIG",
       [](v1::SensorGeometry& g) {
         for (int i = 1; i < 384; ++i) g.add_masked_taxels(i);
         g.add_auxiliary_taxels(0);
       }},
  };
  const v1::SensorGeometry good = LayoutToProto(*LayoutPreset("cody-forearm"));
  for (size_t i = 0; i < std::size(cases); ++i) {
    v1::SensorGeometry geometry = good;
    cases[i].spoil(geometry);
    EXPECT_EQ(ReasonOf(LayoutFromProto(geometry).status()), cases[i].reason)
        << i;
  }
}

}  // namespace
}  // namespace tactus::internal
