#include "core/hmm/expectation.h"

namespace tactus::internal {

Expectation::Expectation(const std::vector<SequenceView>& sequences)
    : batches_(MakeBatches(sequences)) {
  for (const SequenceBatch& batch : batches_) {
    if (smoothers_.empty() || smoothers_.back().lanes() != batch.lanes()) {
      smoothers_.emplace_back(batch.lanes());
    }
  }
}

ExpectedCounts Expectation::Compute(const GaussianHmm& model, Counts wanted) {
  ExpectedCounts counts(model.states, model.dimensions);
  auto batch = batches_.begin();
  for (ForwardBackward& smoother : smoothers_) {
    smoother.SetModel(model);
    for (; batch != batches_.end() && batch->lanes() == smoother.lanes();
         ++batch) {
      smoother.Add(*batch, wanted);
    }
    smoother.AddTo(counts);
  }
  return counts;
}

}  // namespace tactus::internal
