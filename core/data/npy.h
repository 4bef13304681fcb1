// File: npy.h
//
// Reads NumPy's .npy files (format versions 1 and 2): little-endian uint16,
// float32 or float64 in C order, up to three dimensions. Anything else, object
// arrays and Fortran order among it, is refused.
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

namespace tactus {

// One of the three vectors is filled, row-major.
struct NpyArray {
  std::vector<size_t> shape;
  std::vector<uint16_t> u16;
  std::vector<float> f32;
  std::vector<double> f64;
};

// Reads a file. IO or TRIAL_FILE_INVALID.
absl::StatusOr<NpyArray> ReadNpy(const std::string& path);

// The same for bytes in memory; `path` is for error messages only.
absl::StatusOr<NpyArray> ParseNpy(absl::string_view path,
                                  absl::string_view bytes);

}  // namespace tactus
