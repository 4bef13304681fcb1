// File: load_file.h
//
// Cross-axis matrices from a CSV file with the columns taxel, reading_x,
// reading_y, reading_z, load_x, load_y and load_z: the readings above the
// baseline, and the loads in the layout's unit, at which taxels of three axes
// were pressed and pulled. The taxel `*` is each taxel without lines.
//
//   TACTUS_ASSIGN_OR_RETURN(const LoadFile known, ReadLoads("loads.csv", 16));
//   options.cross_axis = known.cross_axis;
//
// Thread-safe: free functions without state.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/drivers/calibration/cross_axis.h"
#include "core/skin/layout.h"

namespace tactus::internal::client {

struct LoadFile {
  // One matrix for all taxels if each line has the taxel `*`; else one per
  // taxel, nothing for those without lines if no line has `*`.
  CrossAxes cross_axis;
  // Root of the mean squared error of the fitted loads along each axis, in the
  // layout's unit.
  AxisVector residual = {};
  size_t lines = 0;
};

// OK if the file of gain curves is given only for one axis, and that of known
// loads only for three; else INVALID_CONFIG, which names the other one. The
// names are empty for files that are not given.
absl::Status CheckLoadFlags(const std::string& gains, const std::string& loads,
                            const SkinLayout& layout);

// IO, TRIAL_FILE_INVALID with the line, or INVALID_CONFIG with the taxel: those
// of FitCrossAxis, or a file without lines.
absl::StatusOr<LoadFile> ReadLoads(const std::string& path, int taxels);

}  // namespace tactus::internal::client
