// A skin with a pitch of 1e308 m had a cylinder of infinite radius and put NaN
// and infinity on the wire.
#include <limits>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/bundle/bundle.h"
#include "core/bundle/model_proto.h"
#include "core/skin/layout_proto.h"
#include "gtest/gtest.h"
#include "tests/support/sealed_bundle.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

struct Bounds {
  const char* field;
  void (v1::SensorGeometry::*set)(double);
  double least;
  double most;
};

constexpr Bounds kBounds[] = {
    {"row_pitch_m", &v1::SensorGeometry::set_row_pitch_m,
     limits::kMinTaxelPitchM, limits::kMaxTaxelPitchM},
    {"column_pitch_m", &v1::SensorGeometry::set_column_pitch_m,
     limits::kMinTaxelPitchM, limits::kMaxTaxelPitchM},
    {"taxel_area_m2", &v1::SensorGeometry::set_taxel_area_m2,
     limits::kMinTaxelAreaM2, limits::kMaxTaxelAreaM2},
    // Below the onset threshold, above the contact threshold.
    {"contact_threshold", &v1::SensorGeometry::set_contact_threshold,
     limits::kMinThreshold, 0.5},
    {"onset_threshold", &v1::SensorGeometry::set_onset_threshold, 0.1,
     limits::kMaxTaxelValue},
};

v1::SensorGeometry Geometry() {
  v1::SensorGeometry geometry = LayoutToProto(*LayoutPreset("cody-forearm"));
  geometry.set_layout("a skin");
  geometry.set_contact_threshold(0.1);
  geometry.set_onset_threshold(0.5);
  return geometry;
}

TEST(GeometryWithoutBoundsTest, EachFieldHasTwo) {
  ASSERT_TRUE(LayoutFromProto(Geometry()).ok());
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Bounds& bounds : kBounds) {
    for (const double good : {bounds.least, bounds.most}) {
      v1::SensorGeometry geometry = Geometry();
      (geometry.*bounds.set)(good);
      EXPECT_TRUE(LayoutFromProto(geometry).ok()) << bounds.field << good;
    }
    for (const double bad :
         {bounds.least / 2, bounds.most * 2, 1e308, 1e-320, 0.0, -1.0, infinity,
          -infinity, std::numeric_limits<double>::quiet_NaN()}) {
      v1::SensorGeometry geometry = Geometry();
      (geometry.*bounds.set)(bad);
      const absl::Status status = LayoutFromProto(geometry).status();
      EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << bounds.field << bad;
    }
  }
}

TEST(GeometryWithoutBoundsTest, ThoseOfBundlesTheSame) {
  Model model = testing::SmallModel();
  model.layout = *LayoutPreset("cody-forearm");
  v1::ModelBundle bundle = ModelToProto(model);
  ASSERT_TRUE(
      DecodeBundle(testing::SealedBundle(bundle.SerializeAsString())).ok());
  bundle.mutable_geometry()->set_column_pitch_m(1e308);
  EXPECT_EQ(
      ReasonOf(DecodeBundle(testing::SealedBundle(bundle.SerializeAsString()))
                   .status()),
      "INVALID_CONFIG");
}

}  // namespace
}  // namespace tactus::internal
