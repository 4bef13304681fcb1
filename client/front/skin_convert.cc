#include "client/front/skin_convert.h"

#include <limits>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/skin/layout_proto.h"

namespace tactus::client {
namespace {

constexpr float kLargestUint16 = std::numeric_limits<uint16_t>::max();

// The message holds no negative numbers; it is checked whole later.
absl::Status CheckCount(const char* field, int value) {
  if (value >= 0) return absl::OkStatus();
  return InvalidConfig(field, value, "0 or more");
}

absl::StatusOr<v1::SensorGeometry> ToGeometry(const Skin& skin) {
  TACTUS_RETURN_IF_ERROR(CheckCount("skin.rows", skin.rows));
  TACTUS_RETURN_IF_ERROR(CheckCount("skin.columns", skin.columns));
  v1::SensorGeometry geometry;
  geometry.set_layout(skin.name);
  geometry.set_rows(skin.rows);
  geometry.set_columns(skin.columns);
  geometry.set_row_pitch_m(skin.row_pitch_m);
  geometry.set_column_pitch_m(skin.column_pitch_m);
  geometry.set_taxel_area_m2(skin.taxel_area_m2);
  geometry.set_wrap_columns(skin.wrap_columns);
  // A preset has its own.
  if (skin.rows != 0 || skin.columns != 0) {
    geometry.set_unit(skin.unit == SkinUnit::kNewton ? v1::TAXEL_UNIT_NEWTON
                                                     : v1::TAXEL_UNIT_COUNTS);
  }
  geometry.set_contact_threshold(skin.contact_threshold);
  geometry.set_onset_threshold(skin.onset_threshold);
  for (const int taxel : skin.masked_taxels) {
    TACTUS_RETURN_IF_ERROR(CheckCount("skin.masked_taxels", taxel));
    geometry.add_masked_taxels(taxel);
  }
  if (skin.only_side_neighbours) {
    geometry.set_connectivity(v1::CONNECTIVITY_4);
  }
  if (skin.light_touch) {
    const SkinLightTouch& light = *skin.light_touch;
    TACTUS_RETURN_IF_ERROR(CheckCount("skin.light_touch.rows", light.rows));
    TACTUS_RETURN_IF_ERROR(
        CheckCount("skin.light_touch.columns", light.columns));
    v1::LightTouch* out = geometry.mutable_light_touch();
    out->set_window_s(light.window_s);
    out->set_rows(light.rows);
    out->set_columns(light.columns);
    out->set_contact_threshold(light.contact_threshold);
    out->set_onset_threshold(light.onset_threshold);
  }
  return geometry;
}

absl::Status CopyWhole(const std::vector<float>& values,
                       std::vector<uint16_t>& out) {
  out.resize(values.size());
  for (size_t i = 0; i < values.size(); ++i) {
    const float value = values[i];
    // Written so that NaN is refused.
    if (!(value >= 0 && value <= kLargestUint16) ||
        value != static_cast<float>(static_cast<uint16_t>(value))) {
      return InvalidConfig(absl::StrCat("frame.values[", i, "]"), value,
                           "a whole number from 0 to 65535, or the encoding "
                           "kFloat32 of the skin");
    }
    out[i] = static_cast<uint16_t>(value);
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<SkinInfo> ToSkinInfo(const Skin& skin) {
  SkinInfo info;
  TACTUS_ASSIGN_OR_RETURN(const v1::SensorGeometry geometry, ToGeometry(skin));
  TACTUS_ASSIGN_OR_RETURN(info.layout, LayoutFromProto(geometry));
  info.taxel_type = skin.encoding == TaxelEncoding::kUint16
                        ? v1::TAXEL_TYPE_UINT16
                        : v1::TAXEL_TYPE_FLOAT32;
  info.scale = skin.scale;
  info.sample_rate_hz = skin.sample_rate_hz;
  info.with_poses = skin.with_poses;
  return info;
}

Skin ToSkin(const SkinInfo& info) {
  const SkinLayout& layout = info.layout;
  Skin skin = {
      .name = layout.name,
      .rows = layout.rows,
      .columns = layout.columns,
      .row_pitch_m = layout.row_pitch_m,
      .column_pitch_m = layout.column_pitch_m,
      .taxel_area_m2 = layout.taxel_area_m2,
      .wrap_columns = layout.wrap_columns,
      .unit = layout.unit == TaxelUnit::kNewton ? SkinUnit::kNewton
                                                : SkinUnit::kCounts,
      .contact_threshold = layout.contact_threshold,
      .onset_threshold = layout.onset_threshold,
      .only_side_neighbours = layout.connectivity == Connectivity::kFour,
      .encoding = info.taxel_type == v1::TAXEL_TYPE_UINT16
                      ? TaxelEncoding::kUint16
                      : TaxelEncoding::kFloat32,
      .scale = info.scale,
      .sample_rate_hz = info.sample_rate_hz,
      .with_poses = info.with_poses};
  for (size_t i = 0; i < layout.mask.size(); ++i) {
    if (layout.mask[i] == 0) skin.masked_taxels.push_back(static_cast<int>(i));
  }
  if (layout.light_touch) {
    const LightTouch& light = *layout.light_touch;
    skin.light_touch = {.window_s = light.window_s,
                        .rows = light.rows,
                        .columns = light.columns,
                        .contact_threshold = light.contact_threshold,
                        .onset_threshold = light.onset_threshold};
  }
  return skin;
}

absl::Status ToSkinFrame(const Frame& frame, const SkinInfo& info,
                         SkinFrame& out) {
  const auto taxels = static_cast<size_t>(info.layout.taxels());
  if (frame.values.size() != taxels) {
    return InvalidConfig("number of frame.values", frame.values.size(),
                         absl::StrCat(taxels, ", the skin's taxels"));
  }
  if (info.taxel_type == v1::TAXEL_TYPE_UINT16) {
    TACTUS_RETURN_IF_ERROR(CopyWhole(frame.values, out.u16));
  } else {
    out.f32 = frame.values;
  }
  out.capture_time_ns = frame.capture_time_ns;
  out.missing_before = frame.missing_before;
  const LinkPose& pose = frame.pose;
  out.pose.position = {pose.x, pose.y, pose.z};
  out.pose.orientation = Eigen::Quaterniond(pose.qw, pose.qx, pose.qy, pose.qz);
  return absl::OkStatus();
}

void ToFrame(const SkinFrame& frame, const SkinInfo& info, Frame& out) {
  out.capture_time_ns = frame.capture_time_ns;
  out.missing_before = frame.missing_before;
  if (info.taxel_type == v1::TAXEL_TYPE_UINT16) {
    out.values.assign(frame.u16.begin(), frame.u16.end());
  } else {
    out.values = frame.f32;
  }
  const Eigen::Vector3d& position = frame.pose.position;
  const Eigen::Quaterniond& turn = frame.pose.orientation;
  out.pose = {.x = position.x(),
              .y = position.y(),
              .z = position.z(),
              .qx = turn.x(),
              .qy = turn.y(),
              .qz = turn.z(),
              .qw = turn.w()};
}

}  // namespace tactus::client
