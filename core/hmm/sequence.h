// File: sequence.h
//
// SequenceView: the observations of one training trial.
//
//   std::vector<double> data(frames * dimensions);  // [T x D] row-major
//   SequenceView view{data.data(), frames, dimensions};
//
// Owns nothing; the data must outlive the view. Thread-safe to read.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "absl/status/status.h"

namespace tactus::internal {

struct SequenceView {
  const double* data = nullptr;  // [frames x dimensions] row-major
  int frames = 0;
  int dimensions = 0;

  std::span<const double> frame(int t) const {
    return {data + static_cast<size_t>(t) * dimensions,
            static_cast<size_t>(dimensions)};
  }
};

// INVALID_TRAINING_DATA, with the sequence's index, if there are no sequences,
// a sequence has no frames, dimensions are out of limits or differ, or a number
// is not finite.
absl::Status Validate(const std::vector<SequenceView>& sequences);

// The number of frames of all sequences.
size_t TotalFrames(const std::vector<SequenceView>& sequences);

// Mean and variance per dimension, [D] each, over all frames.
struct FrameMoments {
  std::vector<double> mean;
  std::vector<double> variance;
};
FrameMoments ComputeFrameMoments(const std::vector<SequenceView>& sequences);

}  // namespace tactus::internal
