// What a cue states holds: which symmetries do not change it, and which
// features it needs.
#include <cmath>
#include <vector>

#include "core/cues/cue_group.h"
#include "core/cues/cue_tracker.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

constexpr int kTaxels = 12;

// How a contact differs from the first one.
struct Change {
  double force = 1;
  double area = 1;
  double motion = 1;
  int frames = 4000;
};

TaxelEmbedding SomeEmbedding() {
  TaxelEmbedding embedding;
  embedding.taxels = kTaxels;
  embedding.dimensions = kMaxEmbedding;
  for (int i = 0; i < kTaxels * 2 * kMaxEmbedding; ++i) {
    embedding.weights.push_back(static_cast<float>(std::sin(1 + 2.3 * i)));
  }
  return embedding;
}

// The cues at the end of a contact that is pressed, slides a little on the way
// and moves over the skin.
std::vector<double> CuesAfter(const Change& change) {
  const TaxelEmbedding embedding = SomeEmbedding();
  CueTracker tracker(100, kAllCueGroups, &embedding);
  for (int t = 1; t <= change.frames; ++t) {
    const double u = static_cast<double>(t) / change.frames;
    const double force =
        change.force * (1.5 + 2 * u + 0.6 * std::sin(5 * u) - u * u);
    ContactSample sample = {
        {0.4 * force,
         change.area * 1e-3 * (1.2 + 0.5 * std::sin(2.5 * u) + 0.3 * u),
         change.motion * 0.01 * (0.2 + u + 0.2 * std::sin(4 * u))},
        force};
    for (int i = 0; i < kProfileSize; ++i) {
      sample.profile[i] = std::sqrt(force * (1 + i) / 100);
    }
    sample.spread = {static_cast<float>(1e-4 * (1 + u)),
                     static_cast<float>(4e-4 * (2 - u))};
    sample.shear = {
        static_cast<float>(0.3 * force * std::cos(2 * u)),
        static_cast<float>((0.1 + 0.2 * u * u) * force * std::sin(2 * u))};
    std::vector<TaxelLoad> loads;
    for (int i = 0; i < kTaxels; ++i) {
      const double distance = i - 4 - 3 * u;
      // Far taxels are touched later: so the number of touched ones changes.
      if (std::abs(distance) > 3 + 2 * u) continue;
      loads.push_back(
          {static_cast<uint32_t>(i),
           static_cast<float>(force * std::exp(-distance * distance / 4))});
    }
    sample.loads = loads;
    tracker.Step(sample, t);
  }
  std::vector<double> cues;
  for (int i = 0; i < CueCount(); ++i) {
    cues.push_back(tracker.value(static_cast<Cue>(i)));
  }
  return cues;
}

// Calls `visit` with each cue and its row.
template <typename Visit>
void ForEachRow(Visit visit) {
  int cue = 0;
  for (const CueGroup& group : AllCueGroups()) {
    for (const CueRow& row : group.rows) {
      for (int i = 0; i < row.count; ++i) visit(static_cast<Cue>(cue++), row);
    }
  }
}

TEST(SymmetryTest, ACueIsUnchangedByWhatItStatesAndByNothingElse) {
  struct Symmetry {
    unsigned bit;
    absl::string_view name;
    Change change;
    // Largest change of what is unchanged: windows are a smaller part of a
    // slower contact, and floats round.
    double tolerance;
  };
  const Symmetry symmetries[] = {
      {kPace, "pace", {.frames = 8000}, 0.05},
      {kLoad, "load", {.force = 0.5, .motion = 0.5}, 1e-5},
      {kStiffness, "stiffness", {.force = 3}, 1e-5}};
  const std::vector<double> before = CuesAfter({});
  for (const Symmetry& symmetry : symmetries) {
    const std::vector<double> after = CuesAfter(symmetry.change);
    ForEachRow([&](Cue cue, const CueRow& row) {
      const size_t i = static_cast<size_t>(cue);
      const double change = std::abs(after[i] - before[i]) /
                            std::max({1.0, std::abs(before[i]) / 3});
      const bool stated = (row.unchanged_by & symmetry.bit) != 0;
      // In a slow contact all rates are nearly 0, at any pace.
      if (symmetry.bit == kPace && !stated) return;
      EXPECT_EQ(change <= symmetry.tolerance, stated)
          << CueName(cue) << " under another " << symmetry.name << ": "
          << before[i] << ", then " << after[i];
    });
  }
}

TEST(SymmetryTest, ACueDoesNotDependOnFeaturesThatItDoesNotNeed) {
  const Change changes[kFeatureCount] = {
      {.force = 1.7}, {.area = 1.7}, {.motion = 1.7}};
  const std::vector<double> before = CuesAfter({});
  for (int f = 0; f < kFeatureCount; ++f) {
    const std::vector<double> after = CuesAfter(changes[f]);
    ForEachRow([&](Cue cue, const CueRow& row) {
      if ((row.needs & (1U << f)) != 0) return;
      EXPECT_EQ(after[static_cast<size_t>(cue)],
                before[static_cast<size_t>(cue)])
          << CueName(cue);
    });
  }
}

TEST(SymmetryTest, EveryCueSaysWhatItMeans) {
  ForEachRow([](Cue cue, const CueRow& row) {
    EXPECT_FALSE(row.meaning.empty()) << CueName(cue);
  });
}

}  // namespace
}  // namespace tactus::internal
