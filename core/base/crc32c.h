// File: crc32c.h
//
// CRC32C (Castagnoli, RFC 3720), which finds damage on the way.
//
//   uint32_t crc = 0;
//   for (const auto& chunk : chunks) crc = ExtendCrc32c(crc, chunk);
//
// Thread-safe: a free function without state.
#pragma once

#include <cstdint>

#include "absl/strings/string_view.h"

namespace tactus::internal {

// The CRC32C of some bytes followed by `bytes`, where `crc` is that of the
// former; 0 for none.
uint32_t ExtendCrc32c(uint32_t crc, absl::string_view bytes);

}  // namespace tactus::internal
