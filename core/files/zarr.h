// File: zarr.h
//
// Zarr's format, version 2: a folder is a group, which has arrays, other groups
// and attributes. Each array is a folder of chunks. Arrays go in and out as in
// npz.h, by names such as "touches/00/label"; those of a single value are
// attributes of their group.
//
//   TACTUS_RETURN_IF_ERROR(WriteZarr("out/a", {{"t", NpyBytes({2}, time)}}));
//   TACTUS_ASSIGN_OR_RETURN(NpzArrays arrays, ReadZarr("out/a"));
//   arrays.at("t").f64;
//
// Chunks are written by zlib, along the first axis. Those that are read may be
// plain or packed by zlib or gzip, in order C, of any shape. Nothing that is
// read is trusted: sizes are checked before memory is taken. Source: the
// specification "Zarr storage version 2". Thread-safe: free functions without
// state.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/files/npz.h"

namespace tactus::internal {

// Makes the group `folder`, which must not exist, of arrays that NpyBytes or
// NpyText made. The same arrays give the same files. `.zgroup` of the group
// itself comes last, so that half a group is none. IO or TRIAL_FILE_INVALID.
absl::Status WriteZarr(
    const std::string& folder,
    const std::vector<std::pair<std::string, std::string>>& arrays);

// Makes `folder` a group if it is none.
absl::Status MakeZarrGroup(const std::string& folder);
bool IsZarrGroup(const std::string& folder);
bool IsZarrArray(const std::string& folder);

// All arrays and attributes of a group and of the groups in it, as large as
// one trial may be. IO or TRIAL_FILE_INVALID, with the folder.
absl::StatusOr<NpzArrays> ReadZarr(const std::string& folder);

}  // namespace tactus::internal
