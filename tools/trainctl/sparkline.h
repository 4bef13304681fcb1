// File: sparkline.h
//
// A curve as one line of block characters, for terminals.
//
//   Sparkline(std::vector<double>{1, 2, 3, 8}, 20)   "▁▂▃█"
//
// Thread-safe: free functions without state.
#pragma once

#include <span>
#include <string>

namespace tactus::internal::client {

// At most `width` characters, each the mean of as many values, from the lowest
// to the highest block. Values that are not finite are left out. Equal values
// are lowest blocks.
std::string Sparkline(std::span<const double> values, size_t width);

}  // namespace tactus::internal::client
