// File: disk_use.h
//
// How much of a disk a data directory uses, by kind.
//
//   const v1::DataUse use = MeasureData("/data");
//   use.blob_bytes();
//
// Reads the sizes of all files: a second for a few hundred thousand blobs.
// Files that come or go meanwhile may be counted or not.
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <string>

#include "tactus/v1/admin.pb.h"

namespace tactus::internal {

// `folder`: as DataDirectory::Open. What cannot be read counts as 0.
v1::DataUse MeasureData(const std::string& folder);

// Free bytes of the file system that holds `folder`; -1 if that is unknown.
int64_t FreeBytes(const std::string& folder);

}  // namespace tactus::internal
