// File: compression.h
//
// Decompresses what other programs compress: chunks of MCAP files and messages
// of bags, by zstd and LZ4.
//
//   std::string records;
//   const std::string fault = Decompress("zstd", bytes, size, &records);
//   if (!fault.empty()) return TrialFileInvalid(path, fault);
//
// The caller bounds `size`: no more memory than that is taken, whatever the
// bytes say. Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <string>

#include "absl/strings/string_view.h"

namespace tactus::internal {

// `compression` is "zstd" or "lz4", whose frames `bytes` are. Sets `out` to the
// `size` bytes that were compressed. Returns what is wrong; empty for nothing.
std::string Decompress(absl::string_view compression, absl::string_view bytes,
                       uint64_t size, std::string* out);

// True if `bytes` begin as those of zstd do.
bool IsZstd(absl::string_view bytes);

// The size that the first frame of zstd states; 0 if it states none.
uint64_t ZstdSize(absl::string_view bytes);

}  // namespace tactus::internal
