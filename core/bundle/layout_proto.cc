#include "core/bundle/layout_proto.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus {
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

// Takes over what may be given beside a preset's name as well.
absl::Status ApplyRefinements(const v1::SensorGeometry& geometry,
                              SkinLayout& layout) {
  if (geometry.contact_threshold() != 0) {
    layout.contact_threshold = geometry.contact_threshold();
    // Both thresholds keep their distance unless the onset's is given too.
    layout.onset_threshold =
        std::max(layout.onset_threshold, layout.contact_threshold);
  }
  if (geometry.onset_threshold() != 0) {
    layout.onset_threshold = geometry.onset_threshold();
  }
  switch (geometry.connectivity()) {
    case v1::CONNECTIVITY_UNSPECIFIED:
      break;
    case v1::CONNECTIVITY_4:
      layout.connectivity = Connectivity::kFour;
      break;
    case v1::CONNECTIVITY_8:
      layout.connectivity = Connectivity::kEight;
      break;
    default:
      return InvalidConfig("geometry.connectivity",
                           static_cast<int>(geometry.connectivity()),
                           "CONNECTIVITY_4 or CONNECTIVITY_8");
  }
  if (geometry.masked_taxels_size() > 0) {
    layout.mask.assign(layout.taxels(), 1);
    for (uint32_t index : geometry.masked_taxels()) {
      if (index >= layout.mask.size()) {
        return InvalidConfig("geometry.masked_taxels", index,
                             absl::StrCat("below ", layout.mask.size()));
      }
      layout.mask[index] = 0;
    }
  }
  return absl::OkStatus();
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
  for (size_t i = 0; i < layout.mask.size(); ++i) {
    if (layout.mask[i] == 0) {
      geometry.add_masked_taxels(static_cast<uint32_t>(i));
    }
  }
  return geometry;
}

absl::StatusOr<SkinLayout> LayoutFromProto(const v1::SensorGeometry& geometry) {
  SkinLayout layout;
  if (geometry.rows() == 0 && geometry.columns() == 0) {
    TACTUS_ASSIGN_OR_RETURN(layout, LayoutPreset(geometry.layout()));
  } else {
    // Checked before the cast: a huge value must not come out small.
    if (geometry.rows() > limits::kMaxRows) {
      return InvalidConfig("geometry.rows", geometry.rows(),
                           absl::StrCat("1 to ", limits::kMaxRows));
    }
    if (geometry.columns() > limits::kMaxColumns) {
      return InvalidConfig("geometry.columns", geometry.columns(),
                           absl::StrCat("1 to ", limits::kMaxColumns));
    }
    layout.name = geometry.layout();
    layout.rows = static_cast<int>(geometry.rows());
    layout.columns = static_cast<int>(geometry.columns());
    layout.row_pitch_m = geometry.row_pitch_m();
    layout.column_pitch_m = geometry.column_pitch_m();
    layout.taxel_area_m2 = geometry.taxel_area_m2();
    layout.wrap_columns = geometry.wrap_columns();
    TACTUS_ASSIGN_OR_RETURN(layout.unit, UnitFromProto(geometry.unit()));
  }
  TACTUS_RETURN_IF_ERROR(ApplyRefinements(geometry, layout));
  TACTUS_RETURN_IF_ERROR(Validate(layout));
  return layout;
}

}  // namespace tactus
