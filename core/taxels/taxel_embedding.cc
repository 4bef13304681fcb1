#include "core/taxels/taxel_embedding.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/taxels/components.h"

namespace tactus::internal {
absl::Status Validate(const TaxelEmbedding& embedding) {
  if (embedding.taxels < 0 || embedding.taxels > limits::kMaxTaxels) {
    return InvalidModel("taxels of the embedding", embedding.taxels,
                        absl::StrCat("0 to ", limits::kMaxTaxels));
  }
  if (embedding.dimensions < 0 || embedding.dimensions > kMaxEmbedding) {
    return InvalidModel("dimensions of the embedding", embedding.dimensions,
                        absl::StrCat("0 to ", kMaxEmbedding));
  }
  const size_t weights =
      size_t{2} * static_cast<size_t>(embedding.taxels) * embedding.dimensions;
  if (embedding.weights.size() != weights) {
    return InvalidModel("weights of the embedding", embedding.weights.size(),
                        absl::StrCat(weights, ", two per taxel and dimension"));
  }
  for (const float weight : embedding.weights) {
    // Written so that a NaN fails.
    if (!(std::abs(weight) <= limits::kMaxInputScale)) {
      return InvalidModel("weight of the embedding", weight,
                          absl::StrCat("within ", limits::kMaxInputScale));
    }
  }
  return absl::OkStatus();
}

EmbeddingTracker::EmbeddingTracker(const TaxelEmbedding* embedding,
                                   double sample_rate_hz)
    : embedding_(embedding),
      window_(std::max(1.0, kWindowS * sample_rate_hz)) {}

void EmbeddingTracker::Step(std::span<const TaxelLoad> loads) {
  const int count = dimensions();
  if (count == 0) return;
  std::array<double, 2 * kMaxEmbedding> sums = {};
  for (const TaxelLoad& load : WithoutComponents(loads, embedding_->taxels)) {
    const float* weights = &embedding_->weights[size_t{2} * load.taxel * count];
    for (int i = 0; i < 2 * count; ++i) {
      sums[i] += static_cast<double>(weights[i]) * load.root;
    }
  }
  ++frames_;
  const double weight = 1 / std::min(static_cast<double>(frames_), window_);
  for (int d = 0; d < count; ++d) {
    const double change = sums[count + d];
    if (frames_ == 1) mean_[d] = change;
    mean_[d] += weight * (change - mean_[d]);
    values_[d] = sums[d] + change - mean_[d];
  }
}

}  // namespace tactus::internal
