// File: stream_settings.h
//
// StreamSettings: a StreamConfig with every field checked and every default
// filled in.
//
//   auto settings = ParseStreamConfig(config);
//
// Plain data and free functions; thread-safe.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "core/classify/contact_pipeline.h"
#include "core/skin/layout.h"
#include "core/skin/taxel_values.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal {

struct StreamSettings {
  std::string model;
  SkinLayout layout;
  v1::TaxelType taxel_type = v1::TAXEL_TYPE_UINT16;
  // Wire value times scale is the value in the layout's unit; above 0.
  double scale = 1;
  bool with_poses = false;
  bool with_taxels = false;
  bool with_diagnostics = false;
  // Never UNSPECIFIED.
  v1::ResultCadence cadence = v1::RESULT_CADENCE_EVERY_FRAME;
  // At least 1.
  uint32_t result_interval_frames = 1;
  ContactPipeline::Options pipeline;
  std::string client_id;

  // Bytes of one value on the wire.
  size_t taxel_bytes() const { return TaxelBytes(taxel_type); }
  // Nanoseconds between frames.
  double frame_period_ns() const { return 1e9 / pipeline.sample_rate_hz; }
};

// INVALID_CONFIG naming the field, or UNKNOWN_LAYOUT.
absl::StatusOr<StreamSettings> ParseStreamConfig(
    const v1::StreamConfig& config);

}  // namespace tactus::internal
