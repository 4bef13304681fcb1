// File: cue_tracker.h
//
// CueTracker: the cues of a contact, computed causally from its samples so far.
// The derived cues combine the raw features as the lumped element model (paper,
// eqs. 1 to 7) suggests: while an object does not slide, force over motion is
// its stiffness; once it slides, the force is constant and the motion
// continues; the area grows with the strain. Ratios and logarithms of features
// also hold at arm stiffnesses and speeds that were never trained.
//
//   CueTracker tracker(/*sample_rate_hz=*/100);
//   tracker.Step(sample, /*frames_since_onset=*/1);
//   double cue = tracker.value(NamedCue("log_spring"));
//
// A group of cues that was not asked for costs nothing, and the logarithms of a
// group are computed when one of them is first read. Memory is constant; only
// the constructor allocates. Not thread-safe: one per stream.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/cues/cue.h"
#include "core/cues/cue_group.h"
#include "core/features/feature.h"
#include "core/taxels/taxel_embedding.h"

namespace tactus::internal {

class CueTracker {
 public:
  // `sample_rate_hz` must be above 0. Cues of groups outside of `groups` stay
  // 0; the raw features are always there. `embedding` must outlive the tracker;
  // without one, or if it is of no taxels, the cues made from taxels stay 0.
  explicit CueTracker(double sample_rate_hz, CueGroups groups = kAllCueGroups,
                      const TaxelEmbedding* embedding = nullptr);

  // Forgets the contact.
  void Reset();

  // Takes the next touched frame. `frames_since_onset` counts from 1 and
  // includes lost and untouched frames. Any finite values are safe.
  void Step(const ContactSample& sample, uint64_t frames_since_onset);

  // Returns the cue after the last Step(); 0 before the first.
  double value(Cue cue) {
    const int part = part_of_[static_cast<size_t>(cue)];
    if (part >= 0 && !parts_[part].derived) Derive(parts_[part]);
    return values_[static_cast<size_t>(cue)];
  }

 private:
  // A group that is computed.
  struct Part {
    std::unique_ptr<CueComputation> computation;
    // Its cues in values_.
    size_t first = 0;
    size_t count = 0;
    // True if they are those of the last Step().
    bool derived = true;
  };

  void Derive(Part& part);

  double smooth_window_;
  double frames_ = 0;
  FeatureVector smooth_ = {};
  std::vector<Part> parts_;
  // Index in parts_; -1 for cues that are not computed.
  std::vector<int> part_of_;
  std::vector<double> values_;
};

}  // namespace tactus::internal
