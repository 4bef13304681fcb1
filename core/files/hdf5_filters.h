// File: hdf5_filters.h
//
// The filters through which the chunks of an HDF5 dataset went, and whether
// this program can undo them.
//
//   TACTUS_RETURN_IF_ERROR(CheckFilters(properties, "taxels", complain));
//
// Not thread-safe, like HDF5 itself.
#pragma once

#include "absl/status/status.h"
#include "core/files/hdf5_read.h"

namespace tactus::internal {

// TRIAL_FILE_INVALID, with the name and number of the first filter that is not
// read, those that are, and what to do, about the part `name`. `properties` is
// the dataset's list of creation properties.
absl::Status CheckFilters(hid_t properties, absl::string_view name,
                          const Hdf5Complaint& complain);

}  // namespace tactus::internal
