// File: features.h
//
// Segmentation of skin frames against OpenCV's connected components.
#pragma once

#include <memory>

#include "tests/bench/benchmark.h"

namespace tactus::client {

// Rows features/contact, features/contact_flat (columns do not wrap) and
// features/idle (nothing touched), ns a frame of 16 x 24 taxels, threshold
// included. The peer's regions end at the seam where ours wrap: joining them
// would cost it more. Fails unless both find the same regions in a million
// random frames, where the peer's are joined across the seam.
std::unique_ptr<Benchmark> MakeFeaturesBenchmark();

}  // namespace tactus::client
