// File: sequence_batch.h
//
// Sequences side by side, so that training fills vectors however few states a
// model has: sequence k of a batch is lane k, all begin together.
//
//   for (const SequenceBatch& batch : MakeBatches(sequences)) {
//     batch.frame(t);
//   }
//
// Thread-safe: values. Observations are copied.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/hmm/scaled_kernels.h"
#include "core/hmm/sequence.h"

namespace tactus {

struct SequenceBatch {
  int dimensions = 0;
  std::vector<int> lengths;  // frames of each lane, longest first
  // Patterns (scaled_kernels.h): [frames][D][kPattern]. A lane that has ended
  // repeats its last frame, which counts for nothing.
  AlignedVector<double> observations;

  int lanes() const { return static_cast<int>(lengths.size()); }
  int frames() const { return lengths.front(); }
  const double* frame(int t) const {
    return &observations[static_cast<size_t>(t) * dimensions *
                         kPattern<double>];
  }
};

// Sequences of like lengths together; lanes are powers of two, at most a
// vector of them, most first. sequences: valid.
std::vector<SequenceBatch> MakeBatches(
    const std::vector<SequenceView>& sequences);

}  // namespace tactus
