#include "core/taxels/taxel_embedding.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

constexpr int kTaxels = 30;
constexpr int kDimensions = 5;
using Roots = std::vector<float>;  // the root of each taxel's load

TaxelEmbedding RandomEmbedding(Random& random) {
  TaxelEmbedding embedding;
  embedding.taxels = kTaxels;
  embedding.dimensions = kDimensions;
  for (int i = 0; i < 2 * kTaxels * kDimensions; ++i) {
    embedding.weights.push_back(static_cast<float>(random.Gaussian()));
  }
  return embedding;
}

std::vector<Roots> RandomFrames(Random& random, int count) {
  std::vector<Roots> frames(count, Roots(kTaxels));
  for (Roots& frame : frames) {
    for (float& root : frame) {
      if (random.Uniform() < 0.4) root = static_cast<float>(random.Uniform());
    }
  }
  return frames;
}

std::vector<TaxelLoad> Touched(const Roots& frame) {
  std::vector<TaxelLoad> loads;
  for (uint32_t t = 0; t < frame.size(); ++t) {
    if (frame[t] > 0) loads.push_back({t, frame[t]});
  }
  return loads;
}

// From the definition: the level, and the level less its running mean over 20
// frames (0.2 s at 100 Hz).
std::vector<double> Direct(const TaxelEmbedding& embedding,
                           const std::vector<Roots>& frames) {
  std::vector<double> mean(kTaxels);
  for (size_t n = 0; n < frames.size(); ++n) {
    const double weight = 1 / std::min(static_cast<double>(n + 1), 20.0);
    for (int t = 0; t < kTaxels; ++t) {
      mean[t] += weight * (frames[n][t] - mean[t]);
    }
  }
  std::vector<double> values(kDimensions);
  for (int t = 0; t < kTaxels; ++t) {
    const float* weights = &embedding.weights[2 * t * kDimensions];
    for (int d = 0; d < kDimensions; ++d) {
      const double level = frames.back()[t];
      values[d] +=
          weights[d] * level + weights[kDimensions + d] * (level - mean[t]);
    }
  }
  return values;
}

std::vector<double> Tracked(EmbeddingTracker& tracker,
                            const std::vector<Roots>& frames) {
  for (const Roots& frame : frames) tracker.Step(Touched(frame));
  return {tracker.values().begin(), tracker.values().end()};
}

TEST(EmbeddingTrackerTest, IsTheMapOfLevelAndChange) {
  Random random(3);
  const TaxelEmbedding embedding = RandomEmbedding(random);
  EmbeddingTracker tracker(&embedding, 100);
  for (const int count : {1, 2, 19, 20, 60}) {
    const auto frames = RandomFrames(random, count);
    tracker.Reset();
    EXPECT_THAT(Tracked(tracker, frames),
                ::testing::Pointwise(::testing::DoubleNear(1e-12),
                                     Direct(embedding, frames)))
        << count;
  }
}

TEST(EmbeddingTrackerTest, RenumberedTaxelsGiveTheSame) {
  Random random(4);
  const TaxelEmbedding embedding = RandomEmbedding(random);
  const auto frames = RandomFrames(random, 40);
  std::vector<int> place(kTaxels);
  std::iota(place.begin(), place.end(), 0);
  std::reverse(place.begin(), place.end());
  std::swap(place[3], place[11]);
  TaxelEmbedding renumbered = embedding;
  auto moved = frames;
  for (int t = 0; t < kTaxels; ++t) {
    std::copy_n(&embedding.weights[2 * t * kDimensions], 2 * kDimensions,
                &renumbered.weights[2 * place[t] * kDimensions]);
    for (size_t n = 0; n < frames.size(); ++n) {
      moved[n][place[t]] = frames[n][t];
    }
  }
  EmbeddingTracker tracker(&embedding, 100);
  EmbeddingTracker other(&renumbered, 100);
  EXPECT_THAT(Tracked(other, moved),
              ::testing::Pointwise(::testing::DoubleNear(1e-12),
                                   Tracked(tracker, frames)));
}

TEST(TaxelEmbeddingTest, WrongSizesAndWeightsAreRefused) {
  Random random(5);
  const TaxelEmbedding good = RandomEmbedding(random);
  EXPECT_TRUE(Validate(good).ok());
  EXPECT_TRUE(Validate(TaxelEmbedding{}).ok());
  TaxelEmbedding bad = good;
  bad.weights.pop_back();
  EXPECT_EQ(ReasonOf(Validate(bad)), "INVALID_MODEL");
  bad = good;
  bad.weights[7] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(ReasonOf(Validate(bad)), "INVALID_MODEL");
  bad = good;
  bad.dimensions = kMaxEmbedding + 1;
  EXPECT_EQ(ReasonOf(Validate(bad)), "INVALID_MODEL");
  bad = good;
  bad.taxels = -1;
  EXPECT_EQ(ReasonOf(Validate(bad)), "INVALID_MODEL");
}

}  // namespace
}  // namespace tactus::internal
