#include "client/front/skin_convert.h"

#include <limits>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(SkinConvertTest, ANameAloneIsAPreset) {
  const auto info = ToSkinInfo({.name = "cody-forearm", .scale = 0.001});
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(info->layout, *LayoutPreset("cody-forearm"));
  EXPECT_EQ(info->scale, 0.001);
  EXPECT_EQ(ReasonOf(ToSkinInfo({.name = "my-arm"}).status()),
            "UNKNOWN_LAYOUT");
  // Its shape cannot be changed in part.
  const auto reshaped = ToSkinInfo({.name = "cody-forearm", .row_pitch_m = 1});
  EXPECT_EQ(ReasonOf(reshaped.status()), "INVALID_CONFIG");
}

TEST(SkinConvertTest, APresetMayHaveOtherThresholdsAndAMask) {
  const auto info = ToSkinInfo({.name = "cody-forearm",
                                .contact_threshold = 0.5,
                                .masked_taxels = {7},
                                .only_side_neighbours = true});
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(info->layout.contact_threshold, 0.5);
  EXPECT_EQ(info->layout.mask[7], 0);
  EXPECT_EQ(info->layout.mask[8], 1);
  EXPECT_EQ(info->layout.connectivity, Connectivity::kFour);
}

TEST(SkinConvertTest, EveryFieldComesBack) {
  SkinInfo info;
  info.layout = {.name = "palm",
                 .rows = 4,
                 .columns = 6,
                 .row_pitch_m = 0.005,
                 .column_pitch_m = 0.006,
                 .taxel_area_m2 = 25e-6,
                 .wrap_columns = true,
                 .unit = TaxelUnit::kCounts,
                 .contact_threshold = 3,
                 .onset_threshold = 4,
                 .connectivity = Connectivity::kFour,
                 .mask = std::vector<uint8_t>(24, 1),
                 .light_touch = LightTouch{.window_s = 0.1,
                                           .rows = 2,
                                           .columns = 3,
                                           .contact_threshold = 1,
                                           .onset_threshold = 2}};
  info.layout.mask[5] = 0;
  info.layout.axes = 3;
  info.layout.normal_axis = 2;
  info.layout.signed_values = true;
  info.taxel_type = v1::TAXEL_TYPE_INT16;
  info.scale = 0.5;
  info.sample_rate_hz = 50;
  info.with_poses = true;
  const auto same = ToSkinInfo(ToSkin(info));
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_EQ(*same, info);
}

TEST(SkinConvertTest, WrongNumbersAreNamed) {
  EXPECT_THAT(
      ToSkinInfo({.name = "palm", .rows = -1, .columns = 4}).status().message(),
      HasSubstr("skin.rows"));
  EXPECT_THAT(ToSkinInfo({.name = "cody-forearm", .masked_taxels = {-3}})
                  .status()
                  .message(),
              HasSubstr("skin.masked_taxels"));
}

TEST(SkinConvertTest, FramesGoThereAndBack) {
  SkinInfo info = *ToSkinInfo({.name = "icub-6x10"});
  Frame frame;
  frame.capture_time_ns = 5;
  frame.missing_before = 2;
  for (int i = 0; i < 60; ++i) frame.values.push_back(1'000.0F * i);
  frame.values[1] = 65'535;
  frame.pose = {
      .x = 1, .y = 2, .z = 3, .qx = 0.5, .qy = 0.5, .qz = 0.5, .qw = 0.5};
  for (const v1::TaxelType type :
       {v1::TAXEL_TYPE_UINT16, v1::TAXEL_TYPE_FLOAT32}) {
    info.taxel_type = type;
    SkinFrame there;
    ASSERT_TRUE(ToSkinFrame(frame, info, there).ok());
    EXPECT_EQ(there.pose.orientation.w(), 0.5);
    Frame back;
    ToFrame(there, info, back);
    EXPECT_EQ(back.values, frame.values);
    EXPECT_EQ(back.capture_time_ns, 5);
    EXPECT_EQ(back.missing_before, 2u);
    EXPECT_EQ(back.pose.z, 3);
  }
}

TEST(SkinConvertTest, SignedValuesOfThreeAxesGoThereAndBack) {
  const auto info = ToSkinInfo({.name = "pad",
                                .rows = 2,
                                .columns = 2,
                                .row_pitch_m = 0.005,
                                .column_pitch_m = 0.005,
                                .taxel_area_m2 = 25e-6,
                                .contact_threshold = 3,
                                .onset_threshold = 4,
                                .axes = 3,
                                .signed_values = true,
                                .encoding = TaxelEncoding::kInt16});
  ASSERT_TRUE(info.ok()) << info.status();
  Frame frame;
  for (int i = 0; i < 12; ++i) {
    frame.values.push_back(static_cast<float>(i % 2 == 0 ? i : -i));
  }
  frame.values[3] = -32'768;
  SkinFrame there;
  ASSERT_TRUE(ToSkinFrame(frame, *info, there).ok());
  EXPECT_EQ(there.i16[3], -32'768);
  Frame back;
  ToFrame(there, *info, back);
  EXPECT_EQ(back.values, frame.values);
  frame.values[3] = 32'768;
  EXPECT_THAT(ToSkinFrame(frame, *info, there).message(),
              HasSubstr("-32768 to 32767"));
}

TEST(SkinConvertTest, ValuesThatTheEncodingCannotHoldAreRefused) {
  const SkinInfo info = *ToSkinInfo({.name = "icub-6x10"});
  SkinFrame out;
  Frame frame;
  frame.values.assign(59, 0.0F);
  EXPECT_THAT(ToSkinFrame(frame, info, out).message(),
              HasSubstr("60, the skin's values"));
  frame.values.push_back(0);
  for (const float bad :
       {-1.0F, 0.5F, 65'536.0F, std::numeric_limits<float>::quiet_NaN(),
        std::numeric_limits<float>::infinity()}) {
    frame.values[3] = bad;
    const absl::Status status = ToSkinFrame(frame, info, out);
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << bad;
    EXPECT_THAT(status.message(), HasSubstr("frame.values[3]"));
  }
}

}  // namespace
}  // namespace tactus::internal::client
