#include "core/stream/stream_settings.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/skin/layout_proto.h"

namespace tactus::internal {
namespace {

constexpr double kDefaultSampleRateHz = 100;

absl::Status CheckName(absl::string_view field, absl::string_view name) {
  if (name.size() > limits::kMaxNameBytes) {
    return InvalidConfig(absl::StrCat(field, " length"), name.size(),
                         absl::StrCat("at most ", limits::kMaxNameBytes));
  }
  if (TextFault(name, limits::kMaxNameBytes).empty()) return absl::OkStatus();
  return InvalidConfig(field, Quoted(name), "UTF-8 without control characters");
}

absl::Status ParseTaxels(const v1::StreamConfig& config,
                         StreamSettings& settings) {
  if (TaxelBytes(config.taxel_type()) == 0) {
    return InvalidConfig(
        "taxel_type", static_cast<int>(config.taxel_type()),
        "TAXEL_TYPE_UINT16, TAXEL_TYPE_INT16 or TAXEL_TYPE_FLOAT32");
  }
  if (config.taxel_type() == v1::TAXEL_TYPE_INT16 &&
      !settings.layout.signed_values) {
    return InvalidConfig("taxel_type", "TAXEL_TYPE_INT16",
                         "of a geometry with signed_values");
  }
  settings.taxel_type = config.taxel_type();
  if (config.has_scale()) {
    if (!std::isfinite(config.scale()) || config.scale() <= 0) {
      return InvalidConfig("scale", config.scale(), "finite and above 0");
    }
    settings.scale = config.scale();
  }
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
    case v1::RESULT_CADENCE_EVENTS:
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

absl::Status ParseDecision(const v1::StreamConfig& config,
                           ContactClassifier::Options& options) {
  if (config.has_decision_threshold()) {
    const double threshold = config.decision_threshold();
    if (!(threshold > 0.5 && threshold <= 1)) {
      return InvalidConfig("decision_threshold", threshold,
                           "above 0.5 and at most 1, or absent");
    }
    options.decision_threshold = threshold;
  }
  if (config.has_decision_frames()) {
    const uint32_t frames = config.decision_frames();
    if (frames < 1 || frames > limits::kMaxDecisionFrames) {
      return InvalidConfig(
          "decision_frames", frames,
          absl::StrCat("1 to ", limits::kMaxDecisionFrames, ", or absent"));
    }
    options.decision_frames = frames;
  }
  return absl::OkStatus();
}

absl::Status ParseContacts(const v1::StreamConfig& config,
                           ContactPipeline::Options& options) {
  if (config.has_release_after_ms()) {
    const uint32_t release = config.release_after_ms();
    if (release < 1 || release > limits::kMaxReleaseAfterMs) {
      return InvalidConfig(
          "release_after_ms", release,
          absl::StrCat("1 to ", limits::kMaxReleaseAfterMs, ", or absent"));
    }
    if (config.never_release()) {
      return InvalidConfig("release_after_ms", release,
                           "absent with never_release");
    }
    options.release_after_s = release / 1e3;
  }
  if (config.never_release()) options.release_after_s = -1;
  if (config.has_max_contacts()) {
    const uint32_t most = config.max_contacts();
    if (most < 1 || most > limits::kMaxContacts) {
      return InvalidConfig(
          "max_contacts", most,
          absl::StrCat("1 to ", limits::kMaxContacts, ", or absent"));
    }
    options.max_contacts = static_cast<int>(most);
  }
  return absl::OkStatus();
}

absl::Status ParsePipeline(const v1::StreamConfig& config,
                           ContactPipeline::Options& options) {
  const double rate = config.has_sample_rate_hz() ? config.sample_rate_hz()
                                                  : kDefaultSampleRateHz;
  if (!(rate >= limits::kMinSampleRateHz && rate <= limits::kMaxSampleRateHz)) {
    return InvalidConfig("sample_rate_hz", rate,
                         absl::StrCat(limits::kMinSampleRateHz, " to ",
                                      limits::kMaxSampleRateHz));
  }
  options.sample_rate_hz = rate;
  options.with_poses = config.with_poses();
  TACTUS_RETURN_IF_ERROR(ParseDecision(config, options.decision));
  TACTUS_RETURN_IF_ERROR(ParseContacts(config, options));
  if (!v1::Effort_IsValid(config.effort())) {
    return InvalidConfig("effort", static_cast<int>(config.effort()),
                         "a value of Effort");
  }
  options.decision.scorers =
      config.effort() == v1::EFFORT_LOW ? Scorers::kHmms : Scorers::kAll;
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<StreamSettings> ParseStreamConfig(
    const v1::StreamConfig& config) {
  StreamSettings settings;
  TACTUS_RETURN_IF_ERROR(CheckName("model", config.model()));
  TACTUS_RETURN_IF_ERROR(CheckName("client_id", config.client_id()));
  settings.model = config.model();
  settings.client_id = config.client_id();
  if (!config.has_geometry()) {
    return InvalidConfig("geometry", "missing",
                         "the skin's layout, at least its name");
  }
  TACTUS_RETURN_IF_ERROR(
      CheckName("geometry.layout", config.geometry().layout()));
  TACTUS_ASSIGN_OR_RETURN(settings.layout, LayoutFromProto(config.geometry()));
  TACTUS_RETURN_IF_ERROR(ParseTaxels(config, settings));
  TACTUS_RETURN_IF_ERROR(ParseCadence(config, settings));
  TACTUS_RETURN_IF_ERROR(ParsePipeline(config, settings.pipeline));
  settings.with_taxels = config.with_taxels();
  settings.with_diagnostics = config.with_diagnostics();
  return settings;
}

}  // namespace tactus::internal
