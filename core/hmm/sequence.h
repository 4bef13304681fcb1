// File: sequence.h
//
// The observations of one trial, as training sees them.
//
//   std::vector<double> data(frames * dimensions);  // [T x D] row-major
//   SequenceView view{data.data(), frames, dimensions};
//
// Owns nothing; the data must outlive the view.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "absl/status/status.h"

namespace tactus {

struct SequenceView {
  const double* data = nullptr;  // [frames x dimensions] row-major
  int frames = 0;
  int dimensions = 0;

  std::span<const double> frame(int t) const {
    return {data + static_cast<size_t>(t) * dimensions,
            static_cast<size_t>(dimensions)};
  }
};

// Refuses with INVALID_TRAINING_DATA, naming the sequence: no sequences, one
// without frames, dimensions out of limits or not equal, numbers that are not
// finite.
absl::Status Validate(const std::vector<SequenceView>& sequences);

// Frames of all sequences together.
size_t TotalFrames(const std::vector<SequenceView>& sequences);

// Mean and variance per dimension, [D] each, over all frames.
struct FrameMoments {
  std::vector<double> mean;
  std::vector<double> variance;
};
FrameMoments ComputeFrameMoments(const std::vector<SequenceView>& sequences);

}  // namespace tactus
