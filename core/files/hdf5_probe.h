// File: hdf5_probe.h
//
// Reads a file in a child process before this process opens it: the HDF5
// library can crash, loop or take all memory on a damaged or hostile file.
//
//   TACTUS_RETURN_IF_ERROR(
//       ProbeInChild(path, [&] { return ReadItAll(path); }));
//
// Not thread-safe, like HDF5 itself.
#pragma once

#include <string>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"

namespace tactus::internal {

// Runs `read` in a child process whose processor time and memory are limited,
// both by the size of the file (limits::kMaxProbeBytes at most). OK if `read`
// returns OK. TRIAL_FILE_INVALID with the message of `read` if it returns an
// error, if the child dies or reaches a limit, or if `path` is no regular file.
// IO if there is no such file or no child can be started.
absl::Status ProbeInChild(const std::string& path,
                          absl::FunctionRef<absl::Status()> read);

}  // namespace tactus::internal
