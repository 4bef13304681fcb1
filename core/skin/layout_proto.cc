#include "core/skin/layout_proto.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

absl::StatusOr<TaxelUnit> UnitFromProto(v1::TaxelUnit unit) {
  switch (unit) {
    case v1::TAXEL_UNIT_NEWTON:
      return TaxelUnit::kNewton;
    case v1::TAXEL_UNIT_COUNTS:
      return TaxelUnit::kCounts;
    default:
      return InvalidConfig("geometry.unit", static_cast<int>(unit),
                           "TAXEL_UNIT_NEWTON or TAXEL_UNIT_COUNTS");
  }
}

// Beyond the limit any value is as wrong as the next one.
int BoundedSide(uint32_t side) {
  return static_cast<int>(std::min<uint32_t>(side, 1'000'000));
}

absl::Status ApplyConnectivity(const v1::SensorGeometry& geometry,
                               SkinLayout& layout) {
  switch (geometry.connectivity()) {
    case v1::CONNECTIVITY_UNSPECIFIED:
      return absl::OkStatus();
    case v1::CONNECTIVITY_4:
      layout.connectivity = Connectivity::kFour;
      return absl::OkStatus();
    case v1::CONNECTIVITY_8:
      layout.connectivity = Connectivity::kEight;
      return absl::OkStatus();
    default:
      return InvalidConfig("geometry.connectivity",
                           static_cast<int>(geometry.connectivity()),
                           "CONNECTIVITY_4 or CONNECTIVITY_8");
  }
}

absl::Status ApplyMask(const v1::SensorGeometry& geometry, SkinLayout& layout) {
  if (geometry.masked_taxels().empty()) return absl::OkStatus();
  layout.mask.assign(layout.taxels(), 1);
  for (const uint32_t taxel : geometry.masked_taxels()) {
    if (taxel >= layout.mask.size()) {
      return InvalidConfig("geometry.masked_taxels", taxel,
                           absl::StrCat("below ", layout.mask.size()));
    }
    layout.mask[taxel] = 0;
  }
  if (std::count(layout.mask.begin(), layout.mask.end(), 1) == 0) {
    return InvalidConfig("geometry.masked_taxels", "every taxel",
                         "a part of the taxels");
  }
  return absl::OkStatus();
}

void ApplyLightTouch(const v1::SensorGeometry& geometry, SkinLayout& layout) {
  if (!geometry.has_light_touch()) return;
  const v1::LightTouch& from = geometry.light_touch();
  layout.light_touch = {.window_s = from.window_s(),
                        .rows = BoundedSide(from.rows()),
                        .columns = BoundedSide(from.columns()),
                        .contact_threshold = from.contact_threshold(),
                        .onset_threshold = from.onset_threshold()};
}

void ApplyAxes(const v1::SensorGeometry& geometry, SkinLayout& layout) {
  layout.axes = geometry.axes() == 0 ? 1 : BoundedSide(geometry.axes());
  if (geometry.has_normal_axis()) {
    layout.normal_axis = BoundedSide(geometry.normal_axis());
  }
  layout.signed_values = geometry.signed_values();
}

// A preset may be refined by mask, connectivity, thresholds and light
// touch, not reshaped.
absl::StatusOr<SkinLayout> PresetLayout(const v1::SensorGeometry& geometry) {
  if (geometry.layout().empty()) {
    return InvalidConfig("geometry.layout", "empty",
                         "a preset, or rows and columns must be set");
  }
  if (geometry.row_pitch_m() != 0 || geometry.column_pitch_m() != 0 ||
      geometry.taxel_area_m2() != 0 || geometry.wrap_columns() ||
      geometry.unit() != v1::TAXEL_UNIT_UNSPECIFIED || geometry.axes() != 0 ||
      geometry.has_normal_axis() || geometry.signed_values()) {
    return InvalidConfig("geometry", "a preset with parts of a shape",
                         "a layout name alone, or a shape with rows, columns");
  }
  TACTUS_ASSIGN_OR_RETURN(SkinLayout layout, LayoutPreset(geometry.layout()));
  if (geometry.contact_threshold() != 0) {
    layout.contact_threshold = geometry.contact_threshold();
    // A higher threshold alone lifts the onset's with it.
    layout.onset_threshold =
        std::max(layout.onset_threshold, layout.contact_threshold);
  }
  if (geometry.onset_threshold() != 0) {
    layout.onset_threshold = geometry.onset_threshold();
  }
  return layout;
}

absl::StatusOr<SkinLayout> DescribedLayout(const v1::SensorGeometry& geometry) {
  SkinLayout layout;
  layout.name = geometry.layout();
  layout.rows = BoundedSide(geometry.rows());
  layout.columns = BoundedSide(geometry.columns());
  layout.row_pitch_m = geometry.row_pitch_m();
  layout.column_pitch_m = geometry.column_pitch_m();
  layout.taxel_area_m2 = geometry.taxel_area_m2();
  layout.wrap_columns = geometry.wrap_columns();
  layout.contact_threshold = geometry.contact_threshold();
  layout.onset_threshold = geometry.onset_threshold();
  ApplyAxes(geometry, layout);
  TACTUS_ASSIGN_OR_RETURN(layout.unit, UnitFromProto(geometry.unit()));
  return layout;
}

}  // namespace

v1::SensorGeometry LayoutToProto(const SkinLayout& layout) {
  v1::SensorGeometry geometry;
  geometry.set_layout(layout.name);
  geometry.set_rows(layout.rows);
  geometry.set_columns(layout.columns);
  geometry.set_row_pitch_m(layout.row_pitch_m);
  geometry.set_column_pitch_m(layout.column_pitch_m);
  geometry.set_taxel_area_m2(layout.taxel_area_m2);
  geometry.set_wrap_columns(layout.wrap_columns);
  geometry.set_unit(layout.unit == TaxelUnit::kNewton ? v1::TAXEL_UNIT_NEWTON
                                                      : v1::TAXEL_UNIT_COUNTS);
  geometry.set_contact_threshold(layout.contact_threshold);
  geometry.set_onset_threshold(layout.onset_threshold);
  geometry.set_connectivity(layout.connectivity == Connectivity::kFour
                                ? v1::CONNECTIVITY_4
                                : v1::CONNECTIVITY_8);
  if (layout.light_touch) {
    v1::LightTouch& light = *geometry.mutable_light_touch();
    light.set_window_s(layout.light_touch->window_s);
    light.set_rows(layout.light_touch->rows);
    light.set_columns(layout.light_touch->columns);
    light.set_contact_threshold(layout.light_touch->contact_threshold);
    light.set_onset_threshold(layout.light_touch->onset_threshold);
  }
  if (layout.axes != 1) geometry.set_axes(layout.axes);
  if (layout.normal_axis) geometry.set_normal_axis(*layout.normal_axis);
  geometry.set_signed_values(layout.signed_values);
  geometry.mutable_auxiliary_taxels()->Add(layout.auxiliary.begin(),
                                           layout.auxiliary.end());
  for (size_t i = 0; i < layout.mask.size(); ++i) {
    if (layout.mask[i] == 0 &&
        !std::ranges::binary_search(layout.auxiliary, i)) {
      geometry.add_masked_taxels(static_cast<uint32_t>(i));
    }
  }
  return geometry;
}

absl::StatusOr<SkinLayout> LayoutFromProto(const v1::SensorGeometry& geometry) {
  const bool preset = geometry.rows() == 0 && geometry.columns() == 0;
  TACTUS_ASSIGN_OR_RETURN(SkinLayout layout, preset
                                                 ? PresetLayout(geometry)
                                                 : DescribedLayout(geometry));
  TACTUS_RETURN_IF_ERROR(ApplyConnectivity(geometry, layout));
  ApplyLightTouch(geometry, layout);
  TACTUS_RETURN_IF_ERROR(Validate(layout));
  TACTUS_RETURN_IF_ERROR(ApplyMask(geometry, layout));
  const auto& auxiliary = geometry.auxiliary_taxels();
  TACTUS_RETURN_IF_ERROR(
      AddAuxiliary({auxiliary.begin(), auxiliary.end()}, layout));
  return layout;
}

}  // namespace tactus::internal
