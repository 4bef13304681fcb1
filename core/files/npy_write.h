// File: npy_write.h
//
// Writes NumPy's .npy format, version 1, as bytes: what ParseNpy (npy.h) reads.
//
//   const std::string bytes = NpyBytes({2, 3}, std::span<const
//   double>(values)); NpyText({"HU", "HM"});  // numpy.array(["HU", "HM"])
//
// The same values give the same bytes. Source: NEP 1 "A Simple File Format for
// NumPy Arrays". Thread-safe: free functions without state.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"

namespace tactus::internal {

// `values`, row-major, has as many entries as `shape` calls for; an empty shape
// is a single value.
std::string NpyBytes(const std::vector<size_t>& shape,
                     std::span<const double> values);
std::string NpyBytes(const std::vector<size_t>& shape,
                     std::span<const float> values);
std::string NpyBytes(const std::vector<size_t>& shape,
                     std::span<const uint16_t> values);
std::string NpyBytes(const std::vector<size_t>& shape,
                     std::span<const int16_t> values);

// What stands before the values of an array of `type`, such as "<f4".
std::string NpyHeader(absl::string_view type, const std::vector<size_t>& shape);

// A vector of texts, which are UTF-8.
std::string NpyText(const std::vector<std::string>& texts);
// A single text.
std::string NpyText(absl::string_view text);

}  // namespace tactus::internal
