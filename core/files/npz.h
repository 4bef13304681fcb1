// File: npz.h
//
// NumPy's .npz format: a ZIP archive with one .npy file an array. Reads what
// numpy.savez and numpy.savez_compressed write, and writes it uncompressed.
// Object arrays, which are pickles, are refused.
//
//   const std::string bytes = *NpzBytes({{"time", NpyBytes({2}, time)}});
//   TACTUS_ASSIGN_OR_RETURN(NpzArrays arrays, ParseNpz("a.npz", bytes));
//   arrays.at("time").f64;
//   TACTUS_ASSIGN_OR_RETURN(NpyArray again, ReadNpz("trial.npz", "time"));
//
// Nothing that is read is trusted: sizes are checked before memory is taken,
// and each array must match its CRC-32. Zip64 is read as far as a file below
// 4 GiB needs it. Sources: PKWARE APPNOTE.TXT 6.3, numpy.lib.format.
// Thread-safe: free functions without state.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/files/npy.h"

namespace tactus::internal {

// By name, without the ending .npy.
using NpzArrays = std::map<std::string, NpyArray>;

// TRIAL_FILE_INVALID naming `path`, and the array if one is wrong. `path` is
// for error messages only.
absl::StatusOr<NpzArrays> ParseNpz(absl::string_view path,
                                   absl::string_view bytes);

// Reads a file. IO or TRIAL_FILE_INVALID.
absl::StatusOr<NpzArrays> ReadNpz(const std::string& path);

// The array `name` ("frames" or "frames.npy") alone; what the others hold does
// not matter. An empty name is the only array of the file. TRIAL_FILE_INVALID,
// with the arrays that there are if it is none of them.
absl::StatusOr<NpyArray> ParseNpz(absl::string_view path,
                                  absl::string_view bytes,
                                  absl::string_view name);

// Reads a file. IO or TRIAL_FILE_INVALID.
absl::StatusOr<NpyArray> ReadNpz(const std::string& path,
                                 absl::string_view name);

// An archive of arrays: name without .npy, and bytes that NpyBytes or NpyText
// made. The same arrays give the same bytes. TRIAL_FILE_INVALID if there are
// more than 65,535 arrays or if they have 4 GiB or more.
absl::StatusOr<std::string> NpzBytes(
    const std::vector<std::pair<std::string, std::string>>& arrays);

}  // namespace tactus::internal
