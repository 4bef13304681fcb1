// File: gain_file.h
//
// Gain curves from a CSV file with the columns taxel, reading and load: the
// readings above the baseline, and the loads in the layout's unit, at which
// taxels were pressed. The taxel `*` is each taxel without lines.
//
//   TACTUS_ASSIGN_OR_RETURN(calibration.gains, ReadGains("gains.csv", 384));
//
// Thread-safe: a free function without state.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/drivers/calibration/gain_curve.h"

namespace tactus::internal::client {

// One element per taxel; nothing for those without a curve. IO,
// TRIAL_FILE_INVALID, or INVALID_CONFIG with the taxel.
absl::StatusOr<std::vector<std::optional<GainCurve>>> ReadGains(
    const std::string& path, int taxels);

}  // namespace tactus::internal::client
