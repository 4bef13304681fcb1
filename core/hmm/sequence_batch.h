// File: sequence_batch.h
//
// Sequences side by side, so that training fills vector registers even for
// models of few states. Sequence k of a batch is lane k; all begin at frame 0.
//
//   for (const SequenceBatch& batch : MakeBatches(sequences)) {
//     batch.frame(t);
//   }
//
// Plain data; copies the observations. Thread-safe to read.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/hmm/scaled_kernels.h"
#include "core/hmm/sequence.h"

namespace tactus::internal {

struct SequenceBatch {
  int dimensions = 0;
  std::vector<int> lengths;  // frames of each lane, longest first
  // Patterns (scaled_kernels.h): [frames][D][kPattern]. A lane that has ended
  // repeats its last frame; these repetitions are not counted.
  AlignedVector<double> observations;

  int lanes() const { return static_cast<int>(lengths.size()); }
  int frames() const { return lengths.front(); }
  const double* frame(int t) const {
    return &observations[static_cast<size_t>(t) * dimensions *
                         kPattern<double>];
  }
};

// Groups sequences of similar lengths. The number of lanes is a power of two
// and at most that of a vector; batches with more lanes come first. sequences:
// valid.
std::vector<SequenceBatch> MakeBatches(
    const std::vector<SequenceView>& sequences);

}  // namespace tactus::internal
