#include "server/session/stream_settings.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::server {
namespace {

constexpr double kDefaultSampleRateHz = 100;
constexpr int32_t kDefaultReleaseAfterMs = 500;

absl::Status CheckNameSize(absl::string_view field, size_t size) {
  if (size <= limits::kMaxNameBytes) return absl::OkStatus();
  return InvalidConfig(absl::StrCat(field, " length"), size,
                       absl::StrCat("at most ", limits::kMaxNameBytes));
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

// A preset may be refined by mask, connectivity and thresholds, not reshaped.
absl::StatusOr<SkinLayout> PresetLayout(const v1::SensorGeometry& geometry) {
  if (geometry.layout().empty()) {
    return InvalidConfig("geometry.layout", "empty",
                         "a preset, or rows and columns must be set");
  }
  if (geometry.row_pitch_m() != 0 || geometry.column_pitch_m() != 0 ||
      geometry.taxel_area_m2() != 0 || geometry.wrap_columns() ||
      geometry.unit() != v1::TAXEL_UNIT_UNSPECIFIED) {
    return InvalidConfig("geometry", "a preset with parts of a shape",
                         "a layout name alone, or a shape with rows, columns");
  }
  TACTUS_ASSIGN_OR_RETURN(SkinLayout layout, LayoutPreset(geometry.layout()));
  if (geometry.contact_threshold() != 0) {
    layout.contact_threshold = geometry.contact_threshold();
  }
  if (geometry.onset_threshold() != 0) {
    layout.onset_threshold = geometry.onset_threshold();
  }
  return layout;
}

absl::StatusOr<SkinLayout> DescribedLayout(const v1::SensorGeometry& geometry) {
  SkinLayout layout;
  layout.name = geometry.layout();
  // Beyond the limit any value is as wrong as the next one.
  layout.rows =
      static_cast<int>(std::min<uint32_t>(geometry.rows(), 1'000'000));
  layout.columns =
      static_cast<int>(std::min<uint32_t>(geometry.columns(), 1'000'000));
  layout.row_pitch_m = geometry.row_pitch_m();
  layout.column_pitch_m = geometry.column_pitch_m();
  layout.taxel_area_m2 = geometry.taxel_area_m2();
  layout.wrap_columns = geometry.wrap_columns();
  layout.contact_threshold = geometry.contact_threshold();
  layout.onset_threshold = geometry.onset_threshold();
  switch (geometry.unit()) {
    case v1::TAXEL_UNIT_NEWTON:
      layout.unit = TaxelUnit::kNewton;
      return layout;
    case v1::TAXEL_UNIT_COUNTS:
      layout.unit = TaxelUnit::kCounts;
      return layout;
    default:
      return InvalidConfig("geometry.unit", static_cast<int>(geometry.unit()),
                           "TAXEL_UNIT_NEWTON or TAXEL_UNIT_COUNTS");
  }
}

absl::StatusOr<SkinLayout> ParseGeometry(const v1::SensorGeometry& geometry) {
  TACTUS_RETURN_IF_ERROR(
      CheckNameSize("geometry.layout", geometry.layout().size()));
  const bool preset = geometry.rows() == 0 && geometry.columns() == 0;
  TACTUS_ASSIGN_OR_RETURN(SkinLayout layout, preset
                                                 ? PresetLayout(geometry)
                                                 : DescribedLayout(geometry));
  TACTUS_RETURN_IF_ERROR(ApplyConnectivity(geometry, layout));
  TACTUS_RETURN_IF_ERROR(Validate(layout));
  TACTUS_RETURN_IF_ERROR(ApplyMask(geometry, layout));
  return layout;
}

absl::Status ParseTaxels(const v1::StreamConfig& config,
                         StreamSettings& settings) {
  if (config.taxel_type() != v1::TAXEL_TYPE_UINT16 &&
      config.taxel_type() != v1::TAXEL_TYPE_FLOAT32) {
    return InvalidConfig("taxel_type", static_cast<int>(config.taxel_type()),
                         "TAXEL_TYPE_UINT16 or TAXEL_TYPE_FLOAT32");
  }
  settings.taxel_type = config.taxel_type();
  if (!std::isfinite(config.scale()) || config.scale() < 0) {
    return InvalidConfig("scale", config.scale(), "finite and above 0");
  }
  settings.scale = config.scale() == 0 ? 1 : config.scale();
  settings.with_poses = config.with_poses();
  return absl::OkStatus();
}

absl::Status ParseCadence(const v1::StreamConfig& config,
                          StreamSettings& settings) {
  settings.cadence = config.cadence();
  switch (config.cadence()) {
    case v1::RESULT_CADENCE_UNSPECIFIED:
      settings.cadence = v1::RESULT_CADENCE_EVERY_FRAME;
      return absl::OkStatus();
    case v1::RESULT_CADENCE_EVERY_FRAME:
    case v1::RESULT_CADENCE_ON_CHANGE:
    case v1::RESULT_CADENCE_ON_DECISION:
      return absl::OkStatus();
    case v1::RESULT_CADENCE_EVERY_N_FRAMES:
      break;
    default:
      return InvalidConfig("cadence", static_cast<int>(config.cadence()),
                           "a value of ResultCadence");
  }
  settings.result_interval_frames = config.result_interval_frames();
  if (config.result_interval_frames() < 1 ||
      config.result_interval_frames() > limits::kMaxResultIntervalFrames) {
    return InvalidConfig(
        "result_interval_frames", config.result_interval_frames(),
        absl::StrCat("1 to ", limits::kMaxResultIntervalFrames));
  }
  return absl::OkStatus();
}

absl::Status ParsePipeline(const v1::StreamConfig& config,
                           ContactPipeline::Options& options) {
  const double rate = config.sample_rate_hz() == 0 ? kDefaultSampleRateHz
                                                   : config.sample_rate_hz();
  if (!(rate > 0 && rate <= limits::kMaxSampleRateHz)) {
    return InvalidConfig(
        "sample_rate_hz", rate,
        absl::StrCat("above 0 and at most ", limits::kMaxSampleRateHz));
  }
  options.sample_rate_hz = rate;

  const double threshold = config.decision_threshold();
  if (threshold != 0 && !(threshold > 0.5 && threshold <= 1)) {
    return InvalidConfig("decision_threshold", threshold,
                         "above 0.5 and at most 1, or 0 for the model's");
  }
  options.decision.decision_threshold = threshold;
  if (config.decision_frames() > limits::kMaxDecisionFrames) {
    return InvalidConfig("decision_frames", config.decision_frames(),
                         absl::StrCat("at most ", limits::kMaxDecisionFrames));
  }
  options.decision.decision_frames = config.decision_frames();

  if (config.release_after_ms() > limits::kMaxReleaseAfterMs) {
    return InvalidConfig("release_after_ms", config.release_after_ms(),
                         absl::StrCat("at most ", limits::kMaxReleaseAfterMs));
  }
  const int32_t release_ms = config.release_after_ms() == 0
                                 ? kDefaultReleaseAfterMs
                                 : config.release_after_ms();
  options.release_after_s = release_ms < 0 ? -1 : release_ms / 1e3;
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<StreamSettings> ParseStreamConfig(
    const v1::StreamConfig& config) {
  StreamSettings settings;
  TACTUS_RETURN_IF_ERROR(CheckNameSize("model", config.model().size()));
  TACTUS_RETURN_IF_ERROR(CheckNameSize("client_id", config.client_id().size()));
  settings.model = config.model();
  settings.client_id = config.client_id();
  if (!config.has_geometry()) {
    return InvalidConfig("geometry", "missing",
                         "the skin's layout, at least its name");
  }
  TACTUS_ASSIGN_OR_RETURN(settings.layout, ParseGeometry(config.geometry()));
  TACTUS_RETURN_IF_ERROR(ParseTaxels(config, settings));
  TACTUS_RETURN_IF_ERROR(ParseCadence(config, settings));
  TACTUS_RETURN_IF_ERROR(ParsePipeline(config, settings.pipeline));
  settings.with_features = config.with_features();
  return settings;
}

void LayoutToProto(const SkinLayout& layout, v1::SensorGeometry* geometry) {
  geometry->set_layout(layout.name);
  geometry->set_rows(layout.rows);
  geometry->set_columns(layout.columns);
  geometry->set_row_pitch_m(layout.row_pitch_m);
  geometry->set_column_pitch_m(layout.column_pitch_m);
  geometry->set_taxel_area_m2(layout.taxel_area_m2);
  geometry->set_wrap_columns(layout.wrap_columns);
  geometry->set_unit(layout.unit == TaxelUnit::kNewton ? v1::TAXEL_UNIT_NEWTON
                                                       : v1::TAXEL_UNIT_COUNTS);
  geometry->set_contact_threshold(layout.contact_threshold);
  geometry->set_onset_threshold(layout.onset_threshold);
  for (size_t taxel = 0; taxel < layout.mask.size(); ++taxel) {
    if (layout.mask[taxel] == 0) geometry->add_masked_taxels(taxel);
  }
  geometry->set_connectivity(layout.connectivity == Connectivity::kFour
                                 ? v1::CONNECTIVITY_4
                                 : v1::CONNECTIVITY_8);
}

}  // namespace tactus::server
