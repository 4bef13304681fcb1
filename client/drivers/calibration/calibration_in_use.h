// File: calibration_in_use.h
//
// CalibrationInUse: how a CalibratedDriver made loads of what a skin sent, as a
// recording keeps it, so that the loads can be made again or otherwise.
//
//   const std::string json = ToJson(driver.in_use());
//   TACTUS_ASSIGN_OR_RETURN(const CalibrationInUse again,
//                           CalibrationInUseFromJson(json));
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/drivers/calibration/calibration.h"

namespace tactus::internal::client {

struct CalibrationInUse {
  // Names the skin and how it is connected.
  std::string device;
  // Nothing if the skin was only tared.
  std::optional<Calibration> calibration = std::nullopt;
  // Offsets of a tare at the start, one per value of a frame; empty if there
  // was none.
  std::vector<double> tare = {};
  // The time over which the drift was followed; 0: it was not.
  double drift_time_s = 0;

  bool operator==(const CalibrationInUse&) const = default;
};

// One JSON object (docs/formats.md, "Recordings").
std::string ToJson(const CalibrationInUse& in_use);

// INVALID_CONFIG, which names the part, for any other text. Numbers come back
// with the same bits.
absl::StatusOr<CalibrationInUse> CalibrationInUseFromJson(
    absl::string_view json);

}  // namespace tactus::internal::client
