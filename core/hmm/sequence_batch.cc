#include "core/hmm/sequence_batch.h"

#include <algorithm>
#include <bit>
#include <span>

namespace tactus::internal {
namespace {

SequenceBatch MakeBatch(std::span<const SequenceView> sequences) {
  const int lanes = static_cast<int>(sequences.size());
  SequenceBatch batch;
  batch.dimensions = sequences.front().dimensions;
  for (const SequenceView& sequence : sequences) {
    batch.lengths.push_back(sequence.frames);
  }
  batch.observations.resize(static_cast<size_t>(batch.frames()) *
                            batch.dimensions * kPattern<double>);
  for (int p = 0; p < kPattern<double>; ++p) {
    const SequenceView& sequence = sequences[p % lanes];
    double* x = &batch.observations[p];
    for (int t = 0; t < batch.frames(); ++t) {
      for (const double value :
           sequence.frame(std::min(t, sequence.frames - 1))) {
        *x = value;
        x += kPattern<double>;
      }
    }
  }
  return batch;
}

}  // namespace

std::vector<SequenceBatch> MakeBatches(
    const std::vector<SequenceView>& sequences) {
  std::vector<SequenceView> order = sequences;
  std::ranges::stable_sort(
      order, [](const auto& a, const auto& b) { return a.frames > b.frames; });
  std::vector<SequenceBatch> batches;
  for (std::span<const SequenceView> rest = order; !rest.empty();) {
    const size_t lanes =
        std::min<size_t>(kPattern<double>, std::bit_floor(rest.size()));
    batches.push_back(MakeBatch(rest.first(lanes)));
    rest = rest.subspan(lanes);
  }
  return batches;
}

}  // namespace tactus::internal
