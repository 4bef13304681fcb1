// File: cues.h
//
// Cues: numbers that sequence models see, computed causally from the contact
// samples so far. The raw features are cues; the others put into one number
// what the lumped element model (paper, eqs. 1 to 7) says about an object:
// pressed without sliding, force over motion is its stiffness; once it slides,
// force stays and motion goes on; area grows with strain. Ratios and
// logarithms of them hold at arm stiffnesses and speeds never trained on.
//
//   CueTracker tracker(/*sample_rate_hz=*/100);
//   tracker.Step(sample, /*frames_since_onset=*/1);
//   double cue = tracker.value(Cue::kLogSpring);
//
// Step keeps sums; the derived cues, some thirty logarithms, are computed when
// one of them is first read, and only those of the groups that the tracker was
// asked for. Constant memory; nothing allocates. Not thread-safe: one per
// stream.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "absl/strings/string_view.h"
#include "core/features/feature.h"

namespace tactus {

// "Net" is the force on the whole region; "smooth" a running mean over 50 ms.
enum class Cue {
  kForce,   // the feature itself
  kArea,    // the feature itself
  kMotion,  // the feature itself
  // Logarithms of the smooth features.
  kLogPeak,
  kLogForce,  // net
  kLogArea,
  kLogMotion,
  // Of the time since onset, of motion over it, of force over motion.
  kLogTime,
  kLogSpeed,
  kLogStiffness,
  // One spring through the origin, fitted to all of the contact (log N/m), the
  // stiffest it has been, and the share of force it does not explain (log).
  kLogSpring,
  kLogStiffestSpring,
  kLogSpringMisfit,
  // The same with a free origin, motion on force.
  kLogSlope,
  kLogSlopeMisfit,
  // In the last 0.1 s: change of force over that of motion; deviation over mean
  // (log); relative change of area over that of force.
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
  // Smallest smooth area so far, and how much the area has grown from it.
  kLogFirstArea,
  kAreaGrowth,
  // Largest smooth force so far, and force relative to it.
  kLogLargestForce,
  kForceDrop,
  // Smooth force over area^1.5 (log): once it slides, the object's friction
  // times its density, whatever its size.
  kLogDrag,
  // Root mean square of the changes from frame to frame (log).
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
};
inline constexpr int kCueCount = static_cast<int>(Cue::kColumnLoad9) + 1;

// "log_spring".
absl::string_view CueName(Cue cue);

// Nothing if there is none of that name.
std::optional<Cue> ParseCue(absl::string_view name);

// The raw feature as a cue.
Cue RawCue(Feature feature);

// True if the cue is computed from this feature.
bool NeedsFeature(Cue cue, Feature feature);

// True for the cues of the load profile, which an ideal signal leaves at 0.
constexpr bool IsProfileCue(Cue cue) { return cue >= Cue::kRowLoad0; }

// True for all cues but the raw features and the load profile.
constexpr bool IsDerived(Cue cue) {
  return cue > Cue::kMotion && !IsProfileCue(cue);
}

// Those.
std::vector<Cue> DerivedCues();

// The load profile.
std::vector<Cue> ProfileCues();

// Derived cues are computed by groups; sets of groups are sums of these.
using CueGroups = unsigned;
inline constexpr CueGroups kLevelCues = 1;        // kLogPeak and others
inline constexpr CueGroups kSpringCues = 2;       // kLogSpring to misfits
inline constexpr CueGroups kShortWindowCues = 4;  // of the last 0.1 s
inline constexpr CueGroups kLongWindowCues = 8;   // of the last 0.4 s
inline constexpr CueGroups kRoughnessCues = 16;
inline constexpr CueGroups kAllCueGroups = 31;

// The group of a derived cue; none for others.
CueGroups GroupOf(Cue cue);

class CueTracker {
 public:
  // `sample_rate_hz` > 0. Cues of other groups than `groups` stay 0.
  explicit CueTracker(double sample_rate_hz, CueGroups groups = kAllCueGroups);

  // Forgets the contact.
  void Reset() { state_ = {}; }

  // Takes the next touched frame; `frames_since_onset` counts lost and
  // untouched ones too, from 1. Values of any finite size are safe.
  void Step(const ContactSample& sample, uint64_t frames_since_onset);

  // After the last Step(); 0 before the first.
  double value(Cue cue) {
    if (!state_.derived && IsDerived(cue)) Derive();
    return state_.values[static_cast<int>(cue)];
  }

 private:
  // Mean of all samples, or a running one once they are more than a window.
  struct Mean {
    double value = 0;
    void Step(double x, double share) { value += share * (x - value); }
  };
  // Means, variances and covariances, as Mean.
  struct Moments {
    FeatureVector mean = {};
    FeatureVector variance = {};
    double force_motion = 0;
    double force_area = 0;
    void Step(const FeatureVector& x, double share);
  };
  // Net force, area, motion are the three features here.
  struct State {
    std::array<double, kCueCount> values = {};
    // The derived ones are those of the last Step().
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
    // Mean products at the frame at which their ratio was largest.
    double stiffest_force_motion = 0;
    double stiffest_motion_motion = 0;
    double first_area = 0;
    double largest_force = 0;
    FeatureVector last = {};
    // Mean squared changes.
    std::array<Mean, kFeatureCount> roughness;
  };

  // Weight of the newest sample in a running mean over `window` samples.
  double Share(double window) const;
  void Set(Cue cue, double value) {
    state_.values[static_cast<int>(cue)] = value;
  }
  void StepLevels(const FeatureVector& x, double peak_force);
  void StepSprings(const FeatureVector& x, double share);
  void StepRoughness(const FeatureVector& x, double share);
  bool Has(CueGroups group) const { return (groups_ & group) != 0; }
  // Computes the derived cues from the sums.
  void Derive();
  void DeriveLevels();
  void DeriveSprings();
  // The five cues of a window, from `stiffness` on.
  void DeriveWindow(const Moments& window, Cue stiffness);
  void DeriveRoughness();

  double sample_rate_hz_;
  CueGroups groups_;
  // In samples, at least 1.
  double smooth_window_;
  double short_window_;
  double long_window_;
  double settled_frames_;
  State state_;
};

}  // namespace tactus
