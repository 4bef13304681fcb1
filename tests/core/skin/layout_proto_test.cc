#include "core/skin/layout_proto.h"

#include "core/base/errors.h"
#include "gtest/gtest.h"

namespace tactus {
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
}  // namespace tactus
