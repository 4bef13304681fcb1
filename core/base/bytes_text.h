// File: bytes_text.h
//
// BytesText: a number of bytes as people read it, in B, kB, MB, GB or TB, with
// three digits.
//
//   BytesText(1'234'567)         "1.23 MB"
//   BytesText(78'365'671'424)    "78.4 GB"
//
// Thread-safe: a free function without state.
#pragma once

#include <cstdint>
#include <string>

namespace tactus::internal {

std::string BytesText(int64_t bytes);

}  // namespace tactus::internal
