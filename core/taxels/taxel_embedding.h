// File: taxel_embedding.h
//
// TaxelEmbedding: a linear map from all taxels of a skin to few numbers, for
// skins on which the place or the pattern of the load is the information.
//
// Number d of a frame is the sum over the touched taxels t of level[t][d] times
// the root of t's load, plus the same sum with change[t][d] less its running
// mean over 0.2 s. So a frame is described by what it is like and by how it
// differs from the last few. FitTaxelEmbedding (core/train) learns the map from
// labelled contacts. Renumbering the taxels, in the map and in the frames,
// changes nothing but the order of the sums.
//
//   EmbeddingTracker tracker(&embedding, /*sample_rate_hz=*/100);
//   tracker.Step(sample.loads);
//   const double first = tracker.values()[0];
//
// A TaxelEmbedding is plain data. A tracker refers to one, which must outlive
// it; its memory is constant, nothing allocates. Not thread-safe: one per
// stream.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "absl/status/status.h"
#include "core/taxels/taxel_load.h"

namespace tactus::internal {

inline constexpr int kMaxEmbedding = 24;

struct TaxelEmbedding {
  // Taxels of the skin; 0 if no input is made from them.
  int taxels = 0;
  // Numbers that a frame becomes, at most kMaxEmbedding; 0 without a map.
  int dimensions = 0;
  // For each taxel, `dimensions` weights of the level and then as many of the
  // change.
  std::vector<float> weights;
};

// INVALID_MODEL if a size is wrong or a weight is not finite.
absl::Status Validate(const TaxelEmbedding& embedding);

class EmbeddingTracker {
 public:
  // Window of the running mean.
  static constexpr double kWindowS = 0.2;

  // `sample_rate_hz` above 0. A null embedding has no values.
  EmbeddingTracker(const TaxelEmbedding* embedding, double sample_rate_hz);

  // Forgets the contact.
  void Reset() { frames_ = 0; }

  // Takes the touched taxels of the next touched frame. Taxels beyond those of
  // the embedding must not occur.
  void Step(std::span<const TaxelLoad> loads);

  // One value per dimension.
  std::span<const double> values() const {
    return std::span(values_).first(dimensions());
  }
  int dimensions() const {
    return embedding_ == nullptr ? 0 : embedding_->dimensions;
  }

 private:
  const TaxelEmbedding* embedding_;
  double window_;
  uint64_t frames_ = 0;
  std::array<double, kMaxEmbedding> values_ = {};
  // Running mean of the sums with the weights of the change.
  std::array<double, kMaxEmbedding> mean_ = {};
};

}  // namespace tactus::internal
