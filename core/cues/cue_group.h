// File: cue_group.h
//
// CueGroup: cues that are computed together, with their names, what they are
// computed from, and what does not change them. A group is one file of this
// folder and one line of cue_groups.inc; CONTRIBUTING.md writes one.
//
//   class PeakHeld final : public CueComputation {
//    public:
//     void Reset() override { largest_ = 0; }
//     void Step(const CueStep& step) override {
//       largest_ = std::max(largest_, step.x[kNetForce]);
//     }
//     void Derive(std::span<double> cues) const override {
//       cues[0] = LogAbove(largest_, kForceFloor);
//     }
//
//    private:
//     double largest_ = 0;
//   };
//
// One computation per stream; not thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "absl/strings/string_view.h"
#include "core/cues/cue.h"
#include "core/features/feature.h"
#include "core/taxels/taxel_embedding.h"

namespace tactus::internal {

// Indices of CueStep::x and CueStep::smooth.
inline constexpr int kNetForce = static_cast<int>(Feature::kForce);
inline constexpr int kContactArea = static_cast<int>(Feature::kArea);
inline constexpr int kContactMotion = static_cast<int>(Feature::kMotion);

// Features, as bits of CueRow::needs.
inline constexpr unsigned kNeedsForce = 1U << kNetForce;
inline constexpr unsigned kNeedsArea = 1U << kContactArea;
inline constexpr unsigned kNeedsMotion = 1U << kContactMotion;

// The symmetries of the lumped element model (core/contacts/variation.h), as
// bits of CueRow::unchanged_by. A cue that one of them does not change holds at
// arm speeds, loads or stiffnesses that were never trained.
inline constexpr unsigned kPace = 1;       // the same signals, faster
inline constexpr unsigned kLoad = 2;       // forces and motions times a factor
inline constexpr unsigned kStiffness = 4;  // forces times a factor

// One cue, or `count` of them whose names end in "_0", "_1" and so on.
struct CueRow {
  absl::string_view name;
  unsigned needs = 0;
  unsigned unchanged_by = 0;
  // For docs/cues.md, with units.
  absl::string_view meaning;
  int count = 1;
};

// Window of smooth features, seconds.
inline constexpr double kSmoothS = 0.05;

// A touched frame of the contact. All numbers are finite and within
// kLargestSample.
struct CueStep {
  const ContactSample& sample;
  // Net force, area and motion; their running means over kSmoothS.
  FeatureVector x;
  FeatureVector smooth;
  // Frames that were touched, and all frames since onset; from 1.
  double frames;
  uint64_t frames_since_onset;

  // Weight of this frame in a running mean over `window` frames: a plain mean
  // until there are as many.
  double Weight(double window) const {
    return 1 / (frames < window ? frames : window);
  }
};

class CueComputation {
 public:
  virtual ~CueComputation() = default;
  // Forgets the contact.
  virtual void Reset() = 0;
  // Takes the next touched frame. Called for each frame: updates means, and
  // leaves logarithms to Derive(). Allocates nothing.
  virtual void Step(const CueStep& step) = 0;
  // Writes the cues after the last Step(), in the order of the rows. Called
  // only when one of them is read.
  virtual void Derive(std::span<double> cues) const = 0;
};

struct CueContext {
  double sample_rate_hz;
  // Null, or of no taxels, if there is none. Outlives the computation.
  const TaxelEmbedding* embedding;

  // A length of time in frames, at least 1.
  double Window(double seconds) const {
    const double frames = seconds * sample_rate_hz;
    return frames < 1 ? 1 : frames;
  }
};

struct CueGroup {
  absl::string_view name;
  std::vector<CueRow> rows;
  CueSources sources = 0;
  // Taken by LSTMs by default.
  bool standard = false;
  // Returns null if the cues stay 0 in this context.
  std::unique_ptr<CueComputation> (*make)(const CueContext& context);
};

// Makes a computation from its context.
template <typename Computation>
std::unique_ptr<CueComputation> MakeCues(const CueContext& context) {
  return std::make_unique<Computation>(context);
}

// All groups, in the order of cue_groups.inc.
const std::vector<CueGroup>& AllCueGroups();

}  // namespace tactus::internal
