// File: anyskin_bytes.h
//
// What an AnySkin board sends, written from the public sketch: for each chip
// the temperature, x, y and z as little-endian IEEE 754 numbers, then "\r\n".
// Test-only.
//
//   pty.Write(AnySkinFrame({{.x = 1, .y = 2, .z = 3}}));
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

namespace tactus::internal::client::testing {

struct Chip {
  float t = 25;
  float x = 0;
  float y = 0;
  float z = 0;
};
using Chips = std::vector<Chip>;

inline std::string AnySkinFrame(const Chips& chips) {
  std::string bytes;
  for (const Chip& chip : chips) {
    for (const float number : {chip.t, chip.x, chip.y, chip.z}) {
      const auto bits = std::bit_cast<uint32_t>(number);
      for (int shift = 0; shift < 32; shift += 8) {
        bytes.push_back(static_cast<char>(bits >> shift & 0xFF));
      }
    }
  }
  return bytes + "\r\n";
}

// Without the temperatures.
inline std::vector<float> FieldOf(const Chips& chips) {
  std::vector<float> field;
  for (const Chip& chip : chips) {
    field.insert(field.end(), {chip.x, chip.y, chip.z});
  }
  return field;
}

}  // namespace tactus::internal::client::testing
