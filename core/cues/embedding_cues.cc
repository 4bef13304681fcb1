// A learned linear map of all taxels (core/taxels/taxel_embedding.h).
#include "core/cues/cue_group.h"
#include "core/cues/cue_math.h"

namespace tactus::internal {
namespace {

class EmbeddingValues final : public CueComputation {
 public:
  explicit EmbeddingValues(const CueContext& context)
      : tracker_(context.embedding, context.sample_rate_hz) {}
  void Reset() override { tracker_.Reset(); }
  void Step(const CueStep& step) override { tracker_.Step(step.sample.loads); }
  void Derive(std::span<double> cues) const override {
    std::ranges::transform(tracker_.values(), cues.begin(), ClampSample);
  }

 private:
  EmbeddingTracker tracker_;
};

std::unique_ptr<CueComputation> MakeEmbedding(const CueContext& context) {
  if (context.embedding == nullptr || context.embedding->dimensions == 0) {
    return nullptr;
  }
  return std::make_unique<EmbeddingValues>(context);
}

}  // namespace

CueGroup EmbeddingCues() {
  return {.name = "embedding",
          .rows = {{"embedding", kNeedsForce, kPace,
                    "a linear map of all taxels that is learned from the "
                    "training contacts: discriminants of the classes first, "
                    "then principal components; 0 beyond its dimensions",
                    kMaxEmbedding}},
          .sources = kFromTaxels | kFromEmbedding,
          .make = MakeEmbedding};
}

}  // namespace tactus::internal
