// File: hdf5_probe.h
//
// HDF5 files that others write (h5py's and MATLAB's defaults) have no
// checksums on most of their metadata, and the HDF5 library can crash or loop
// on a damaged one. Such a file is first read in a child process; only if that
// survives is it read here.
//
//   TACTUS_RETURN_IF_ERROR(ProbeInChild(path, [&] { ReadItAll(path); }));
//
// Not thread-safe, like HDF5 itself.
#pragma once

#include <string>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"

namespace tactus {

// True if all metadata of the file reachable without a global heap (where
// text of variable length lies) has checksums: superblock 2 and up.
bool HasChecksums(const std::string& path);

// Runs `read` in a child process. TRIAL_FILE_INVALID if the child died or used
// far more time than such a file can need; OK otherwise, whatever `read` found.
absl::Status ProbeInChild(const std::string& path,
                          absl::FunctionRef<void()> read);

}  // namespace tactus
