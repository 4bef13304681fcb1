// File: npy.h
//
// Reads NumPy's .npy files (format versions 1 to 3): uint16, int16, int64,
// float32, float64 or text (<U), up to four dimensions, of either order of
// bytes and of axes. Other integers, float16 and booleans become float64.
// Anything else, object arrays among it, is refused.
//
//   TACTUS_ASSIGN_OR_RETURN(NpyArray array, ReadNpy("trials/0000.npy"));
//   // array.shape = {605, 384}; array.u16 has 605 x 384 values.
//
// Source: NEP 1 "A Simple File Format for NumPy Arrays". Thread-safe: free
// functions without state.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal {

// One of the vectors is filled, row-major.
struct NpyArray {
  // Empty for a single value.
  std::vector<size_t> shape;
  std::vector<uint16_t> u16;
  std::vector<int16_t> i16;
  std::vector<int64_t> i64;
  std::vector<float> f32;
  std::vector<double> f64;
  // UTF-8.
  std::vector<std::string> text;
};

// Reads a file. IO or TRIAL_FILE_INVALID.
absl::StatusOr<NpyArray> ReadNpy(const std::string& path);

// The same for bytes in memory; `path` is for error messages only.
absl::StatusOr<NpyArray> ParseNpy(absl::string_view path,
                                  absl::string_view bytes);

}  // namespace tactus::internal
