// File: calibration_json.h
//
// A Calibration as text (docs/formats.md, "Calibrations").
//
//   const std::string text = CalibrationToJson(calibration);
//   TACTUS_ASSIGN_OR_RETURN(const Calibration again,
//   CalibrationFromJson(text));
//
// Numbers come back with the same bits. Thread-safe: free functions without
// state.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/drivers/calibration/calibration.h"

namespace tactus::internal::client {

// Largest text that is read.
inline constexpr size_t kMaxCalibrationBytes = 16 * 1024 * 1024;

// One line per part. The calibration is valid.
std::string CalibrationToJson(const Calibration& calibration);

// INVALID_CONFIG if brackets are nested much deeper than in any calibration:
// what takes JSON apart by recursion would not end well.
absl::Status CheckDepth(absl::string_view json);

// A valid calibration; INVALID_CONFIG, which names the part, for any other
// text.
absl::StatusOr<Calibration> CalibrationFromJson(absl::string_view json);

}  // namespace tactus::internal::client
