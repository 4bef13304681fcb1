#include "core/skin/layout.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/limits_skin.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

absl::Status CheckRange(absl::string_view field, double value, double low,
                        double high) {
  // Written so that a NaN fails.
  if (value >= low && value <= high) return absl::OkStatus();
  return InvalidConfig(field, value, absl::StrCat(low, " to ", high));
}

absl::Status CheckSide(absl::string_view field, int value, int limit) {
  if (value >= 1 && value <= limit) return absl::OkStatus();
  return InvalidConfig(field, value, absl::StrCat("1 to ", limit));
}

std::string Differ(absl::string_view field, absl::string_view value,
                   absl::string_view other) {
  if (value == other) return "";
  return absl::StrCat(field, " ", value, ", not ", other);
}

// The shortest text that reads as `value`: six digits could be equal although
// the numbers differ.
std::string AllDigits(double value) {
  char digits[32];
  const std::to_chars_result end =
      std::to_chars(digits, digits + sizeof digits, value);
  return std::string(digits, end.ptr);
}

std::string Differ(absl::string_view field, double value, double other,
                   double tolerance) {
  if (std::abs(value - other) <= tolerance * std::abs(other)) return "";
  return absl::StrCat(field, " ", AllDigits(value), ", not ", AllDigits(other));
}

absl::Status CheckLightTouch(const SkinLayout& layout) {
  using namespace limits;
  if (!layout.light_touch) return absl::OkStatus();
  const LightTouch& light = *layout.light_touch;
  TACTUS_RETURN_IF_ERROR(CheckRange("geometry.light_touch.window_s",
                                    light.window_s, kMinLightWindowS,
                                    kMaxLightWindowS));
  TACTUS_RETURN_IF_ERROR(CheckSide("geometry.light_touch.rows", light.rows,
                                   std::min(layout.rows, kMaxLightSide)));
  TACTUS_RETURN_IF_ERROR(CheckSide("geometry.light_touch.columns",
                                   light.columns,
                                   std::min(layout.columns, kMaxLightSide)));
  TACTUS_RETURN_IF_ERROR(CheckRange("geometry.light_touch.contact_threshold",
                                    light.contact_threshold, kMinLightThreshold,
                                    kMaxTaxelValue));
  return CheckRange("geometry.light_touch.onset_threshold",
                    light.onset_threshold, light.contact_threshold,
                    kMaxTaxelValue);
}

// "off", or every number that `light` has.
std::string LightText(const std::optional<LightTouch>& light) {
  if (!light) return "off";
  return absl::StrCat(light->window_s, " s ", light->rows, "x", light->columns,
                      " ", light->contact_threshold, " ",
                      light->onset_threshold);
}

absl::Status CheckAxes(const SkinLayout& layout) {
  if (layout.axes != 1 && layout.axes != 3) {
    return InvalidConfig("geometry.axes", layout.axes, "1 or 3");
  }
  if (!layout.normal_axis) return absl::OkStatus();
  if (*layout.normal_axis >= 0 && *layout.normal_axis < layout.axes) {
    return absl::OkStatus();
  }
  return InvalidConfig("geometry.normal_axis", *layout.normal_axis,
                       absl::StrCat("0 to ", layout.axes - 1,
                                    ", below geometry.axes, or absent"));
}

absl::Status CheckAuxiliary(const SkinLayout& layout) {
  constexpr absl::string_view kField = "geometry.auxiliary_taxels";
  if (layout.auxiliary.size() > limits::kMaxAuxiliaryTaxels) {
    return InvalidConfig(kField, layout.auxiliary.size(),
                         absl::StrCat("at most ", limits::kMaxAuxiliaryTaxels));
  }
  for (size_t i = 0; i < layout.auxiliary.size(); ++i) {
    const uint32_t taxel = layout.auxiliary[i];
    if (taxel >= static_cast<uint32_t>(layout.taxels())) {
      return InvalidConfig(kField, taxel,
                           absl::StrCat("below ", layout.taxels()));
    }
    if (i > 0 && taxel <= layout.auxiliary[i - 1]) {
      return InvalidConfig(kField, absl::StrCat(taxel, " twice"), "each once");
    }
    if (layout.mask.empty() || layout.mask[taxel] != 0) {
      return InvalidConfig("mask of an auxiliary taxel", 1, "0");
    }
  }
  return absl::OkStatus();
}

// "1, unsigned", or "3, signed, normal 2".
std::string AxesText(const SkinLayout& layout) {
  return absl::StrCat(
      layout.axes, layout.signed_values ? ", signed" : ", unsigned",
      layout.normal_axis ? absl::StrCat(", normal ", *layout.normal_axis) : "");
}

// "4 9", or "none".
std::string AuxiliaryText(const SkinLayout& layout) {
  if (layout.auxiliary.empty()) return "none";
  return absl::StrJoin(layout.auxiliary, " ");
}

absl::string_view UnitName(TaxelUnit unit) {
  return unit == TaxelUnit::kNewton ? "newton" : "counts";
}

SkinLayout CodyForearm() {
  SkinLayout layout;
  layout.name = "cody-forearm";
  layout.rows = 16;
  layout.columns = 24;
  // Rings 10.8 mm apart around a cylinder of radius 46.04 mm; the taxels
  // themselves are 9 mm x 9 mm (paper, Section "Experimental Setup").
  layout.row_pitch_m = 0.0108;
  layout.column_pitch_m = 2 * std::numbers::pi * 0.04604 / 24;
  layout.taxel_area_m2 = 0.009 * 0.009;
  layout.wrap_columns = true;
  layout.unit = TaxelUnit::kNewton;
  layout.contact_threshold = 0.01;
  layout.onset_threshold = 0.02;
  return layout;
}

SkinLayout Vitac() {
  SkinLayout layout;
  layout.name = "vitac-12x32";
  layout.rows = 12;
  layout.columns = 32;
  layout.row_pitch_m = 0.002;
  layout.column_pitch_m = 0.002;
  layout.taxel_area_m2 = 0.002 * 0.002;
  layout.unit = TaxelUnit::kCounts;
  layout.contact_threshold = 20;
  layout.onset_threshold = 40;
  return layout;
}

SkinLayout Icub() {
  SkinLayout layout;
  layout.name = "icub-6x10";
  layout.rows = 6;
  layout.columns = 10;
  // Nominal: triangles of 30 mm side, the taxels of 4 mm diameter in one
  // some 6.5 mm apart.
  layout.row_pitch_m = 0.026;
  layout.column_pitch_m = 0.0065;
  layout.taxel_area_m2 = std::numbers::pi * 0.002 * 0.002;
  layout.unit = TaxelUnit::kCounts;
  // In 680 recorded slides the triangle that is least touched reaches 4 in
  // one reading of 200; the lightest slide presses some taxel to 6.3.
  layout.contact_threshold = 4;
  layout.onset_threshold = 5;
  return layout;
}

}  // namespace

double SkinLayout::CylinderRadius() const {
  return columns * column_pitch_m / (2 * std::numbers::pi);
}

absl::Status Validate(const SkinLayout& layout) {
  TACTUS_RETURN_IF_ERROR(
      CheckSide("geometry.rows", layout.rows, limits::kMaxRows));
  TACTUS_RETURN_IF_ERROR(
      CheckSide("geometry.columns", layout.columns, limits::kMaxColumns));
  TACTUS_RETURN_IF_ERROR(CheckRange("geometry.row_pitch_m", layout.row_pitch_m,
                                    limits::kMinTaxelPitchM,
                                    limits::kMaxTaxelPitchM));
  TACTUS_RETURN_IF_ERROR(
      CheckRange("geometry.column_pitch_m", layout.column_pitch_m,
                 limits::kMinTaxelPitchM, limits::kMaxTaxelPitchM));
  TACTUS_RETURN_IF_ERROR(
      CheckRange("geometry.taxel_area_m2", layout.taxel_area_m2,
                 limits::kMinTaxelAreaM2, limits::kMaxTaxelAreaM2));
  TACTUS_RETURN_IF_ERROR(
      CheckRange("geometry.contact_threshold", layout.contact_threshold,
                 limits::kMinThreshold, limits::kMaxTaxelValue));
  // At least contact_threshold.
  TACTUS_RETURN_IF_ERROR(
      CheckRange("geometry.onset_threshold", layout.onset_threshold,
                 layout.contact_threshold, limits::kMaxTaxelValue));
  if (!layout.mask.empty() &&
      layout.mask.size() != static_cast<size_t>(layout.taxels())) {
    return InvalidConfig("geometry.mask size", layout.mask.size(),
                         absl::StrCat(layout.taxels(), ", one per taxel"));
  }
  TACTUS_RETURN_IF_ERROR(CheckAxes(layout));
  TACTUS_RETURN_IF_ERROR(CheckAuxiliary(layout));
  return CheckLightTouch(layout);
}

absl::Status AddAuxiliary(std::vector<uint32_t> taxels, SkinLayout& layout) {
  if (taxels.empty()) return absl::OkStatus();
  std::ranges::sort(taxels);
  if (layout.mask.empty()) layout.mask.assign(layout.taxels(), 1);
  for (const uint32_t taxel : taxels) {
    if (taxel < layout.mask.size()) layout.mask[taxel] = 0;
  }
  layout.auxiliary = std::move(taxels);
  TACTUS_RETURN_IF_ERROR(CheckAuxiliary(layout));
  if (std::ranges::count(layout.mask, 1) > 0) return absl::OkStatus();
  return InvalidConfig("geometry.auxiliary_taxels",
                       "every taxel that is not masked", "a part of them");
}

std::vector<uint8_t> ValueMask(const SkinLayout& layout) {
  std::vector<uint8_t> mask;
  mask.reserve(layout.mask.size() * layout.axes);
  for (const uint8_t valid : layout.mask) {
    mask.insert(mask.end(), layout.axes, valid);
  }
  for (const uint32_t taxel : layout.auxiliary) {
    std::fill_n(mask.begin() + size_t{taxel} * layout.axes, layout.axes, 1);
  }
  return mask;
}

std::string SkinDifference(const SkinLayout& layout, const SkinLayout& other) {
  // A rounding on the way through text or a shorter number is no difference.
  constexpr double kLength = 1e-6;
  const auto shape = [](const SkinLayout& skin) {
    return absl::StrCat(skin.rows, "x", skin.columns,
                        skin.wrap_columns ? " with wrapped columns" : "");
  };
  const auto neighbours = [](const SkinLayout& skin) {
    return skin.connectivity == Connectivity::kFour ? "4" : "8";
  };
  for (std::string difference :
       {Differ("layout", layout.name, other.name),
        Differ("shape", shape(layout), shape(other)),
        Differ("axes", AxesText(layout), AxesText(other)),
        Differ("auxiliary_taxels", AuxiliaryText(layout), AuxiliaryText(other)),
        Differ("unit", UnitName(layout.unit), UnitName(other.unit)),
        Differ("contact_threshold", layout.contact_threshold,
               other.contact_threshold, 0),
        Differ("onset_threshold", layout.onset_threshold, other.onset_threshold,
               0),
        Differ("row_pitch_m", layout.row_pitch_m, other.row_pitch_m, kLength),
        Differ("column_pitch_m", layout.column_pitch_m, other.column_pitch_m,
               kLength),
        Differ("taxel_area_m2", layout.taxel_area_m2, other.taxel_area_m2,
               kLength),
        Differ("connectivity", neighbours(layout), neighbours(other)),
        layout.light_touch == other.light_touch
            ? ""
            : Differ("light_touch", LightText(layout.light_touch),
                     LightText(other.light_touch))}) {
    if (!difference.empty()) return difference;
  }
  return "";
}

absl::StatusOr<SkinLayout> LayoutPreset(absl::string_view name) {
  std::vector<std::string> names;
  for (const auto make : {CodyForearm, Vitac, Icub}) {
    SkinLayout layout = make();
    if (layout.name == name) return layout;
    names.push_back(std::move(layout.name));
  }
  return UnknownLayout(name, absl::StrJoin(names, ", "));
}

}  // namespace tactus::internal
