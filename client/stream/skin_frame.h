// File: skin_frame.h
//
// SkinInfo and SkinFrame: what a robot's skin is like, and one reading of it,
// as FrameEncoder takes them.
//
//   SkinInfo info;
//   TACTUS_ASSIGN_OR_RETURN(info.layout, LayoutPreset("cody-forearm"));
//   info.scale = 0.001;  // values are millinewtons
//
//   // A skin that is no preset.
//   info.layout = {.name = "my-palm",
//                  .rows = 8,
//                  .columns = 8,
//                  .row_pitch_m = 0.005,
//                  .column_pitch_m = 0.005,
//                  .taxel_area_m2 = 25e-6,
//                  .unit = TaxelUnit::kNewton,
//                  .contact_threshold = 0.01,
//                  .onset_threshold = 0.02};
//
// Plain data, copyable.
#pragma once

#include <cstdint>
#include <vector>

#include "core/skin/frame.h"
#include "core/skin/layout.h"
#include "tactus/v1/common.pb.h"

namespace tactus::internal::client {

// Fixed for the whole stream.
struct SkinInfo {
  // A preset, a preset with changed thresholds or mask, or any other geometry.
  SkinLayout layout;
  v1::TaxelType taxel_type = v1::TAXEL_TYPE_UINT16;
  // Multiplier from values to the layout's unit.
  double scale = 1;
  double sample_rate_hz = 100;
  bool with_poses = false;

  bool operator==(const SkinInfo&) const = default;
};

struct SkinFrame {
  int64_t capture_time_ns = 0;
  // Frames that the skin lost directly before this one, for
  // FrameEncoder::Skip.
  uint64_t missing_before = 0;
  // rows x columns x axes values, row-major. Only the vector of the stream's
  // taxel type is used.
  std::vector<uint16_t> u16;
  std::vector<int16_t> i16;
  std::vector<float> f32;
  // Pose of the skin's link; used only if the stream has poses.
  Pose pose;
};

}  // namespace tactus::internal::client
