#include "client/front/skin_convert.h"

#include <algorithm>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/skin/layout_proto.h"

namespace tactus::internal::client {
namespace {

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
  TACTUS_RETURN_IF_ERROR(CheckCount("skin.axes", skin.axes));
  if (skin.axes != 1) geometry.set_axes(skin.axes);
  if (skin.normal_axis) {
    TACTUS_RETURN_IF_ERROR(CheckCount("skin.normal_axis", *skin.normal_axis));
    geometry.set_normal_axis(*skin.normal_axis);
  }
  geometry.set_signed_values(skin.signed_values);
  geometry.set_contact_threshold(skin.contact_threshold);
  geometry.set_onset_threshold(skin.onset_threshold);
  for (const int taxel : skin.masked_taxels) {
    TACTUS_RETURN_IF_ERROR(CheckCount("skin.masked_taxels", taxel));
    geometry.add_masked_taxels(taxel);
  }
  for (const int taxel : skin.auxiliary_taxels) {
    TACTUS_RETURN_IF_ERROR(CheckCount("skin.auxiliary_taxels", taxel));
    geometry.add_auxiliary_taxels(taxel);
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

template <typename Number>
absl::Status CopyWhole(const std::vector<float>& values,
                       std::vector<Number>& out) {
  constexpr int kLeast = std::numeric_limits<Number>::min();
  constexpr int kMost = std::numeric_limits<Number>::max();
  out.resize(values.size());
  for (size_t i = 0; i < values.size(); ++i) {
    const float value = values[i];
    // Written so that NaN is refused.
    if (!(value >= kLeast && value <= kMost) ||
        value != static_cast<float>(static_cast<Number>(value))) {
      return InvalidConfig(
          absl::StrCat("frame.values[", i, "]"), value,
          absl::StrCat("a whole number from ", kLeast, " to ", kMost,
                       ", or the encoding kFloat32 of the skin"));
    }
    out[i] = static_cast<Number>(value);
  }
  return absl::OkStatus();
}

v1::TaxelType ToTaxelType(TaxelEncoding encoding) {
  switch (encoding) {
    case TaxelEncoding::kUint16:
      return v1::TAXEL_TYPE_UINT16;
    case TaxelEncoding::kInt16:
      return v1::TAXEL_TYPE_INT16;
    case TaxelEncoding::kFloat32:
      return v1::TAXEL_TYPE_FLOAT32;
  }
  return v1::TAXEL_TYPE_UNSPECIFIED;
}

TaxelEncoding ToEncoding(v1::TaxelType type) {
  if (type == v1::TAXEL_TYPE_UINT16) return TaxelEncoding::kUint16;
  return type == v1::TAXEL_TYPE_INT16 ? TaxelEncoding::kInt16
                                      : TaxelEncoding::kFloat32;
}

}  // namespace

absl::StatusOr<SkinInfo> ToSkinInfo(const Skin& skin) {
  SkinInfo info;
  TACTUS_ASSIGN_OR_RETURN(const v1::SensorGeometry geometry, ToGeometry(skin));
  TACTUS_ASSIGN_OR_RETURN(info.layout, LayoutFromProto(geometry));
  info.taxel_type = ToTaxelType(skin.encoding);
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
      .axes = layout.axes,
      .normal_axis = layout.normal_axis,
      .signed_values = layout.signed_values,
      .auxiliary_taxels = {layout.auxiliary.begin(), layout.auxiliary.end()},
      .encoding = ToEncoding(info.taxel_type),
      .scale = info.scale,
      .sample_rate_hz = info.sample_rate_hz,
      .with_poses = info.with_poses};
  for (size_t i = 0; i < layout.mask.size(); ++i) {
    if (layout.mask[i] != 0 ||
        std::ranges::binary_search(layout.auxiliary, i)) {
      continue;
    }
    skin.masked_taxels.push_back(static_cast<int>(i));
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
  const auto values = static_cast<size_t>(info.layout.values());
  if (frame.values.size() != values) {
    return InvalidConfig("number of frame.values", frame.values.size(),
                         absl::StrCat(values, ", the skin's values"));
  }
  if (info.taxel_type == v1::TAXEL_TYPE_UINT16) {
    TACTUS_RETURN_IF_ERROR(CopyWhole(frame.values, out.u16));
  } else if (info.taxel_type == v1::TAXEL_TYPE_INT16) {
    TACTUS_RETURN_IF_ERROR(CopyWhole(frame.values, out.i16));
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
  } else if (info.taxel_type == v1::TAXEL_TYPE_INT16) {
    out.values.assign(frame.i16.begin(), frame.i16.end());
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

}  // namespace tactus::internal::client
