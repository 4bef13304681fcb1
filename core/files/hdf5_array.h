// File: hdf5_array.h
//
// One array of numbers of an HDF5 file, or of a MATLAB file of version 7.3,
// which is one.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const NpyArray array,
//       ReadHdf5Array("trial.h5", "run1/taxels", {}));
//
// Not thread-safe, like HDF5 itself.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/files/npy.h"

namespace tactus::internal {

// HDF5 itself has rows first. MATLAB stores its arrays with all axes reversed,
// and marks them with the attribute MATLAB_class.
enum class Hdf5Order { kAsTheFileSays, kRowsFirst, kColumnsFirst };

// Reads the dataset `name`, "group/dataset"; empty: the only one of the file.
// The shape is that of the program that wrote the file. TRIAL_FILE_INVALID
// lists the datasets if `name` is none of them, or if it is empty and there are
// several; it names the filter of a dataset that is compressed in a way that is
// not read.
absl::StatusOr<NpyArray> ReadHdf5Array(const std::string& path,
                                       const std::string& name,
                                       Hdf5Order order);

}  // namespace tactus::internal
