// File: cues.h
//
// Cues: numbers that the inputs of sequence models are made from. They are
// computed causally from the samples of a contact so far. The raw features are
// cues. The derived cues combine them as the lumped element model (paper, eqs.
// 1 to 7) suggests: while an object does not slide, force over motion is its
// stiffness; once it slides, the force is constant and the motion continues;
// the area grows with the strain. Ratios and logarithms of features also hold
// at arm stiffnesses and speeds that were never trained.
//
//   CueTracker tracker(/*sample_rate_hz=*/100);
//   tracker.Step(sample, /*frames_since_onset=*/1);
//   double cue = tracker.value(Cue::kLogSpring);
//
// Step() only updates means. The derived cues, about thirty logarithms, are
// computed when one of them is first read, and only in the groups given to the
// constructor. Memory is constant; nothing allocates. Not thread-safe: one per
// stream.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "absl/strings/string_view.h"
#include "core/features/feature.h"
#include "core/taxels/taxel_embedding.h"
#include "core/taxels/whole_skin.h"

namespace tactus {

// "Net" is the force on the whole region. "Smooth" is a running mean over 50
// ms.
enum class Cue {
  kForce,   // the feature itself
  kArea,    // the feature itself
  kMotion,  // the feature itself
  // Logarithms of the smooth features.
  kLogPeak,
  kLogForce,  // net
  kLogArea,
  kLogMotion,
  // Logarithms of the time since onset, of motion over time, of force over
  // motion.
  kLogTime,
  kLogSpeed,
  kLogStiffness,
  // Stiffness of one spring through the origin, fitted to the whole contact
  // (log N/m); its largest value so far; the fraction of force that the spring
  // does not explain (log).
  kLogSpring,
  kLogStiffestSpring,
  kLogSpringMisfit,
  // The same with a free origin, by regression of motion on force.
  kLogSlope,
  kLogSlopeMisfit,
  // In the last 0.1 s: change of force over change of motion; deviation over
  // mean (log); relative change of area over relative change of force.
  kStiffnessShort,
  kForceRippleShort,
  kMotionRippleShort,
  kAreaRippleShort,
  kAreaResponseShort,
  // The same in the last 0.4 s.
  kStiffnessLong,
  kForceRippleLong,
  kMotionRippleLong,
  kAreaRippleLong,
  kAreaResponseLong,
  // Smallest smooth area so far, and the growth of the area since then.
  kLogFirstArea,
  kAreaGrowth,
  // Largest smooth force so far, and force relative to it.
  kLogLargestForce,
  kForceDrop,
  // Smooth force over area^1.5 (log). Once the object slides, this is friction
  // times density and does not depend on the size.
  kLogDrag,
  // Root mean square of the change from frame to frame (log).
  kForceRoughness,
  kAreaRoughness,
  kMotionRoughness,
  // The load profile itself.
  kRowLoad0,
  kRowLoad1,
  kRowLoad2,
  kRowLoad3,
  kRowLoad4,
  kRowLoad5,
  kColumnLoad0,
  kColumnLoad1,
  kColumnLoad2,
  kColumnLoad3,
  kColumnLoad4,
  kColumnLoad5,
  kColumnLoad6,
  kColumnLoad7,
  kColumnLoad8,
  kColumnLoad9,
  // The whole skin without places: WholeSkinTracker::Numbers, in their order.
  kSkinForce,
  kSkinTaxels,
  kSkinPeakShare,
  kSkinSpread,
  kSkinForceRate,
  kSkinTaxelsRate,
  kSkinPeakShareRate,
  kSkinSpreadRate,
  kSkinChangeShort,
  kSkinChangeLong,
  kSkinChangeSinceOnset,
  kSkinTravel,
  // The numbers of the taxel embedding; 0 beyond its dimensions.
  kEmbedding0,
  kEmbedding1,
  kEmbedding2,
  kEmbedding3,
  kEmbedding4,
  kEmbedding5,
  kEmbedding6,
  kEmbedding7,
  kEmbedding8,
  kEmbedding9,
  kEmbedding10,
  kEmbedding11,
  kEmbedding12,
  kEmbedding13,
  kEmbedding14,
  kEmbedding15,
  kEmbedding16,
  kEmbedding17,
  kEmbedding18,
  kEmbedding19,
  kEmbedding20,
  kEmbedding21,
  kEmbedding22,
  kEmbedding23,
  // How the net force trembles in the last 0.1 s: root mean square of its
  // change from frame to frame, over its mean (log); root mean square of the
  // change of that change, over the root mean square of the change (log;
  // Hjorth's mobility, Electroencephalography and Clinical Neurophysiology 29,
  // 1970).
  kForceTremorShort,
  kForcePitchShort,
  // The same in the last 0.4 s.
  kForceTremorLong,
  kForcePitchLong,
  // Root of the smooth LoadSpread (log m).
  kLogRowSpread,
  kLogColumnSpread,
};
inline constexpr int kCueCount = static_cast<int>(Cue::kLogColumnSpread) + 1;

// "log_spring".
absl::string_view CueName(Cue cue);

// Returns nothing if no cue has that name.
std::optional<Cue> ParseCue(absl::string_view name);

// Returns the raw feature as a cue.
Cue RawCue(Feature feature);

// True if the cue is computed from this feature.
bool NeedsFeature(Cue cue, Feature feature);

// True for the cues of the load profile. They are 0 for ideal signals.
constexpr bool IsProfileCue(Cue cue) {
  return cue >= Cue::kRowLoad0 && cue <= Cue::kColumnLoad9;
}

// True for the cues of the taxel embedding.
constexpr bool IsEmbeddingCue(Cue cue) {
  return cue >= Cue::kEmbedding0 && cue <= Cue::kEmbedding23;
}

// True for the cues that are made from ContactSample::loads. They are 0 for
// ideal signals.
constexpr bool IsTaxelCue(Cue cue) {
  return cue >= Cue::kSkinForce && cue <= Cue::kEmbedding23;
}

// True for the cues of a fine skin: the tremor of the force and the spread of
// the load. The spread is 0 for ideal signals.
constexpr bool IsFineCue(Cue cue) { return cue >= Cue::kForceTremorShort; }

// True for the cues that are derived from the features.
constexpr bool IsDerived(Cue cue) {
  return cue > Cue::kMotion && cue < Cue::kRowLoad0;
}

// Returns all derived cues.
std::vector<Cue> DerivedCues();

// Returns all cues of the load profile.
std::vector<Cue> ProfileCues();

// Returns all cues of the whole skin without places.
std::vector<Cue> WholeSkinCues();

// Returns all cues of the taxel embedding.
std::vector<Cue> EmbeddingCues();

// Returns all cues of a fine skin.
std::vector<Cue> FineCues();

// Cues other than the features and the load profile are computed by groups. A
// set of groups is a sum of these.
using CueGroups = unsigned;
inline constexpr CueGroups kLevelCues = 1;        // kLogPeak and others
inline constexpr CueGroups kSpringCues = 2;       // kLogSpring to misfits
inline constexpr CueGroups kShortWindowCues = 4;  // of the last 0.1 s
inline constexpr CueGroups kLongWindowCues = 8;   // of the last 0.4 s
inline constexpr CueGroups kRoughnessCues = 16;
inline constexpr CueGroups kWholeSkinCues = 32;
inline constexpr CueGroups kEmbeddingCues = 64;
inline constexpr CueGroups kTremorCues = 128;
inline constexpr CueGroups kSpreadCues = 256;
inline constexpr CueGroups kAllCueGroups = 511;

// Returns the group of a cue; 0 for features and the load profile.
CueGroups GroupOf(Cue cue);

class CueTracker {
 public:
  // `sample_rate_hz` must be above 0. Cues of groups outside of `groups` stay
  // 0. `embedding` must outlive the tracker; without one, or if it is of no
  // taxels, the cues made from taxels stay 0.
  explicit CueTracker(double sample_rate_hz, CueGroups groups = kAllCueGroups,
                      const TaxelEmbedding* embedding = nullptr);

  // Forgets the contact.
  void Reset();

  // Takes the next touched frame. `frames_since_onset` counts from 1 and
  // includes lost and untouched frames. Any finite values are safe.
  void Step(const ContactSample& sample, uint64_t frames_since_onset);

  // Returns the cue after the last Step(); 0 before the first.
  double value(Cue cue) {
    if (!state_.derived && (IsDerived(cue) || IsFineCue(cue))) Derive();
    return state_.values[static_cast<int>(cue)];
  }

 private:
  // Mean of all samples; a running mean once they are more than a window.
  struct Mean {
    double value = 0;
    void Step(double x, double weight) { value += weight * (x - value); }
  };
  // Means, variances and covariances, updated as Mean.
  struct Moments {
    FeatureVector mean = {};
    FeatureVector variance = {};
    double force_motion = 0;
    double force_area = 0;
    void Step(const FeatureVector& x, double weight);
  };
  // Mean squares of a window: of the change from frame to frame, and of the
  // change of that change.
  struct Tremor {
    Mean level;
    Mean change;
    Mean turn;
  };
  // The force here is the net force.
  struct State {
    std::array<double, kCueCount> values = {};
    // True if the derived cues are those of the last Step().
    bool derived = true;
    uint64_t frames = 0;
    uint64_t frames_since_onset = 0;
    Mean peak;
    std::array<Mean, kFeatureCount> smooth;
    Moments short_window;
    Moments long_window;
    Moments contact;
    // Mean products, for the spring through the origin.
    Mean force_motion;
    Mean motion_motion;
    Mean force_force;
    // The mean products at the frame where their ratio was largest.
    double stiffest_force_motion = 0;
    double stiffest_motion_motion = 0;
    double first_area = 0;
    double largest_force = 0;
    FeatureVector last = {};
    // Mean squared changes.
    std::array<Mean, kFeatureCount> roughness;
    double last_force = 0;
    double last_change = 0;
    Tremor short_tremor;
    Tremor long_tremor;
    Mean row_spread;
    Mean column_spread;
  };

  // Weight of the newest sample in a running mean over `window` samples.
  double Weight(double window) const;
  void Set(Cue cue, double value) {
    state_.values[static_cast<int>(cue)] = value;
  }
  void StepTaxels(std::span<const TaxelLoad> loads);
  void StepLevels(const FeatureVector& x, double peak_force);
  void StepSprings(const FeatureVector& x, double weight);
  void StepRoughness(const FeatureVector& x, double weight);
  void StepTremor(double force);
  void StepSpread(const LoadSpread& spread);
  bool Has(CueGroups group) const { return (groups_ & group) != 0; }
  // Computes the derived cues from the means.
  void Derive();
  void DeriveLevels();
  void DeriveSprings();
  // Computes the five cues of a window; `stiffness` is the first of them.
  void DeriveWindow(const Moments& window, Cue stiffness);
  void DeriveRoughness();
  // Computes the two cues of a window; `tremor` is the first of them.
  void DeriveTremor(const Tremor& window, Cue tremor);
  void DeriveSpread();

  double sample_rate_hz_;
  CueGroups groups_;
  // Lengths in samples, at least 1.
  double smooth_window_;
  double short_window_;
  double long_window_;
  double settled_frames_;
  State state_;
  std::optional<WholeSkinTracker> whole_skin_;
  EmbeddingTracker embedding_;
};

}  // namespace tactus
