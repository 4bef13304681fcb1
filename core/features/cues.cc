#include "core/features/cues.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr int kNeedsForce = 1 << static_cast<int>(Feature::kForce);
constexpr int kNeedsArea = 1 << static_cast<int>(Feature::kArea);
constexpr int kNeedsMotion = 1 << static_cast<int>(Feature::kMotion);

struct CueRow {
  absl::string_view name;
  int needs;
};

constexpr CueRow kCues[] = {
    {"force", kNeedsForce},
    {"area", kNeedsArea},
    {"motion", kNeedsMotion},
    {"log_peak", kNeedsForce},
    {"log_force", kNeedsForce},
    {"log_area", kNeedsArea},
    {"log_motion", kNeedsMotion},
    {"log_time", 0},
    {"log_speed", kNeedsMotion},
    {"log_stiffness", kNeedsForce | kNeedsMotion},
    {"log_spring", kNeedsForce | kNeedsMotion},
    {"log_stiffest_spring", kNeedsForce | kNeedsMotion},
    {"log_spring_misfit", kNeedsForce | kNeedsMotion},
    {"log_slope", kNeedsForce | kNeedsMotion},
    {"log_slope_misfit", kNeedsForce | kNeedsMotion},
    {"stiffness_short", kNeedsForce | kNeedsMotion},
    {"force_ripple_short", kNeedsForce},
    {"motion_ripple_short", kNeedsMotion},
    {"area_ripple_short", kNeedsArea},
    {"area_response_short", kNeedsForce | kNeedsArea},
    {"stiffness_long", kNeedsForce | kNeedsMotion},
    {"force_ripple_long", kNeedsForce},
    {"motion_ripple_long", kNeedsMotion},
    {"area_ripple_long", kNeedsArea},
    {"area_response_long", kNeedsForce | kNeedsArea},
    {"log_first_area", kNeedsArea},
    {"area_growth", kNeedsArea},
    {"log_largest_force", kNeedsForce},
    {"force_drop", kNeedsForce},
    {"log_drag", kNeedsForce | kNeedsArea},
    {"force_roughness", kNeedsForce},
    {"area_roughness", kNeedsArea},
    {"motion_roughness", kNeedsMotion},
    {"row_load_0", kNeedsForce},
    {"row_load_1", kNeedsForce},
    {"row_load_2", kNeedsForce},
    {"row_load_3", kNeedsForce},
    {"row_load_4", kNeedsForce},
    {"row_load_5", kNeedsForce},
    {"column_load_0", kNeedsForce},
    {"column_load_1", kNeedsForce},
    {"column_load_2", kNeedsForce},
    {"column_load_3", kNeedsForce},
    {"column_load_4", kNeedsForce},
    {"column_load_5", kNeedsForce},
    {"column_load_6", kNeedsForce},
    {"column_load_7", kNeedsForce},
    {"column_load_8", kNeedsForce},
    {"column_load_9", kNeedsForce},
    {"skin_force", kNeedsForce},
    {"skin_taxels", kNeedsForce | kNeedsArea},
    {"skin_peak_share", kNeedsForce},
    {"skin_spread", kNeedsForce | kNeedsArea},
    {"skin_force_rate", kNeedsForce},
    {"skin_taxels_rate", kNeedsForce | kNeedsArea},
    {"skin_peak_share_rate", kNeedsForce},
    {"skin_spread_rate", kNeedsForce | kNeedsArea},
    {"skin_change_short", kNeedsForce | kNeedsMotion},
    {"skin_change_long", kNeedsForce | kNeedsMotion},
    {"skin_change_since_onset", kNeedsForce | kNeedsMotion},
    {"skin_travel", kNeedsForce | kNeedsMotion},
    {"embedding_0", kNeedsForce},
    {"embedding_1", kNeedsForce},
    {"embedding_2", kNeedsForce},
    {"embedding_3", kNeedsForce},
    {"embedding_4", kNeedsForce},
    {"embedding_5", kNeedsForce},
    {"embedding_6", kNeedsForce},
    {"embedding_7", kNeedsForce},
    {"embedding_8", kNeedsForce},
    {"embedding_9", kNeedsForce},
    {"embedding_10", kNeedsForce},
    {"embedding_11", kNeedsForce},
    {"embedding_12", kNeedsForce},
    {"embedding_13", kNeedsForce},
    {"embedding_14", kNeedsForce},
    {"embedding_15", kNeedsForce},
    {"embedding_16", kNeedsForce},
    {"embedding_17", kNeedsForce},
    {"embedding_18", kNeedsForce},
    {"embedding_19", kNeedsForce},
    {"embedding_20", kNeedsForce},
    {"embedding_21", kNeedsForce},
    {"embedding_22", kNeedsForce},
    {"embedding_23", kNeedsForce},
    {"force_tremor_short", kNeedsForce},
    {"force_pitch_short", kNeedsForce},
    {"force_tremor_long", kNeedsForce},
    {"force_pitch_long", kNeedsForce},
    {"log_row_spread", kNeedsForce | kNeedsArea},
    {"log_column_spread", kNeedsForce | kNeedsArea},
};
static_assert(std::size(kCues) == kCueCount);

constexpr int kFirstProfileCue = static_cast<int>(Cue::kRowLoad0);
constexpr int kFirstWholeSkinCue = static_cast<int>(Cue::kSkinForce);
constexpr int kFirstEmbeddingCue = static_cast<int>(Cue::kEmbedding0);
static_assert(kFirstProfileCue + kProfileSize == kFirstWholeSkinCue);
constexpr int kFirstFineCue = static_cast<int>(Cue::kForceTremorShort);
static_assert(kFirstEmbeddingCue + kMaxEmbedding == kFirstFineCue);

constexpr int kF = static_cast<int>(Feature::kForce);
constexpr int kA = static_cast<int>(Feature::kArea);
constexpr int kM = static_cast<int>(Feature::kMotion);

// Windows, seconds.
constexpr double kSmooth = 0.05;
constexpr double kShort = 0.1;
constexpr double kLong = 0.4;
// Floors of the logarithms: N, m^2, m, fractions of a mean, m.
constexpr double kForceFloor = 1e-6;
constexpr double kAreaFloor = 1e-7;
constexpr double kMotionFloor = 1e-7;
constexpr double kRippleFloor = 1e-6;
constexpr double kSpreadFloor = 1e-5;
// Floor of the fraction of variance that is not explained.
constexpr double kMisfitFloor = 1e-4;
// A signal that varies by a smaller fraction of its mean rests: only rounding
// is left of its deviations.
constexpr double kRest = 1e-7;
// Below these, signed logarithms are nearly linear: N/m, fractions.
constexpr double kStiffnessKnee = 1e3;
constexpr double kAreaKnee = 1e-5;
// Samples are clamped to plus and minus this, so that no product overflows.
constexpr double kLargest = 1e30;
// The anti-aliasing filter has settled after these seconds.
constexpr double kSettled = 0.03;

double Log(double x, double floor) { return std::log(std::max(x, floor)); }

double SignedLog(double x, double knee) {
  return std::copysign(std::log1p(std::abs(x) / knee), x);
}

// Returns 0 for 0 / 0, because a sum of squares may be 0.
double Ratio(double x, double y) { return y > 0 ? x / y : 0; }

std::vector<Cue> CueRange(int first, int end) {
  std::vector<Cue> cues;
  for (int i = first; i < end; ++i) cues.push_back(static_cast<Cue>(i));
  return cues;
}

// Log of the fraction of variance that `product` does not explain.
double Misfit(double product, double x, double y) {
  const double explained = Ratio(product, x) * Ratio(product, y);
  return std::log(1 + kMisfitFloor - std::clamp(explained, 0.0, 1.0));
}

}  // namespace

absl::string_view CueName(Cue cue) { return kCues[static_cast<int>(cue)].name; }

std::optional<Cue> ParseCue(absl::string_view name) {
  for (int i = 0; i < kCueCount; ++i) {
    if (kCues[i].name == name) return static_cast<Cue>(i);
  }
  return std::nullopt;
}

Cue RawCue(Feature feature) {
  return static_cast<Cue>(static_cast<int>(feature));
}

bool NeedsFeature(Cue cue, Feature feature) {
  return (kCues[static_cast<int>(cue)].needs &
          (1 << static_cast<int>(feature))) != 0;
}

std::vector<Cue> DerivedCues() {
  return CueRange(kFeatureCount, kFirstProfileCue);
}

std::vector<Cue> ProfileCues() {
  return CueRange(kFirstProfileCue, kFirstWholeSkinCue);
}

std::vector<Cue> WholeSkinCues() {
  return CueRange(kFirstWholeSkinCue, kFirstEmbeddingCue);
}

std::vector<Cue> EmbeddingCues() {
  return CueRange(kFirstEmbeddingCue, kFirstFineCue);
}

std::vector<Cue> FineCues() { return CueRange(kFirstFineCue, kCueCount); }

void CueTracker::Moments::Step(const FeatureVector& x, double weight) {
  FeatureVector change;
  for (int i = 0; i < kFeatureCount; ++i) {
    change[i] = x[i] - mean[i];
    mean[i] += weight * change[i];
  }
  const double keep = 1 - weight;
  for (int i = 0; i < kFeatureCount; ++i) {
    variance[i] = keep * (variance[i] + weight * change[i] * change[i]);
  }
  force_motion = keep * (force_motion + weight * change[kF] * change[kM]);
  force_area = keep * (force_area + weight * change[kF] * change[kA]);
}

CueGroups GroupOf(Cue cue) {
  if (IsFineCue(cue)) {
    return cue < Cue::kLogRowSpread ? kTremorCues : kSpreadCues;
  }
  if (IsEmbeddingCue(cue)) return kEmbeddingCues;
  if (IsTaxelCue(cue)) return kWholeSkinCues;
  if (!IsDerived(cue)) return 0;
  if (cue < Cue::kLogSpring) return kLevelCues;
  if (cue < Cue::kStiffnessShort) return kSpringCues;
  if (cue < Cue::kStiffnessLong) return kShortWindowCues;
  if (cue < Cue::kLogFirstArea) return kLongWindowCues;
  return cue < Cue::kForceRoughness ? kLevelCues : kRoughnessCues;
}

CueTracker::CueTracker(double sample_rate_hz, CueGroups groups,
                       const TaxelEmbedding* embedding)
    : sample_rate_hz_(sample_rate_hz),
      groups_(groups),
      smooth_window_(std::max(1.0, kSmooth * sample_rate_hz)),
      short_window_(std::max(1.0, kShort * sample_rate_hz)),
      long_window_(std::max(1.0, kLong * sample_rate_hz)),
      settled_frames_(kSettled * sample_rate_hz),
      embedding_(Has(kEmbeddingCues) ? embedding : nullptr, sample_rate_hz) {
  if (Has(kWholeSkinCues) && embedding != nullptr && embedding->taxels > 0) {
    whole_skin_.emplace(embedding->taxels, sample_rate_hz);
  }
}

void CueTracker::Reset() {
  state_ = {};
  if (whole_skin_) whole_skin_->Reset();
  embedding_.Reset();
}

double CueTracker::Weight(double window) const {
  return 1 / std::min(static_cast<double>(state_.frames), window);
}

void CueTracker::Step(const ContactSample& sample,
                      uint64_t frames_since_onset) {
  ++state_.frames;
  state_.frames_since_onset = frames_since_onset;
  state_.derived = false;
  FeatureVector x = {sample.net_force, sample.features[kA],
                     sample.features[kM]};
  for (double& value : x) value = std::clamp(value, -kLargest, kLargest);
  for (int i = 0; i < kFeatureCount; ++i) {
    state_.values[i] = std::clamp(sample.features[i], -kLargest, kLargest);
  }
  for (int i = 0; i < kProfileSize; ++i) {
    state_.values[kFirstProfileCue + i] =
        std::clamp(sample.profile[i], -kLargest, kLargest);
  }
  StepTaxels(sample.loads);
  const double weight = 1 / static_cast<double>(state_.frames);
  if (Has(kShortWindowCues)) state_.short_window.Step(x, Weight(short_window_));
  if (Has(kLongWindowCues)) state_.long_window.Step(x, Weight(long_window_));
  if (Has(kLevelCues)) StepLevels(x, state_.values[kF]);
  if (Has(kSpringCues)) StepSprings(x, weight);
  if (Has(kRoughnessCues)) StepRoughness(x, weight);
  if (Has(kTremorCues)) StepTremor(x[kF]);
  if (Has(kSpreadCues)) StepSpread(sample.spread);
}

void CueTracker::StepTaxels(std::span<const TaxelLoad> loads) {
  if (embedding_.dimensions() > 0) {
    embedding_.Step(loads);
    const auto values = embedding_.values();
    for (size_t i = 0; i < values.size(); ++i) {
      state_.values[kFirstEmbeddingCue + i] =
          std::clamp(values[i], -kLargest, kLargest);
    }
  }
  if (!whole_skin_) return;
  whole_skin_->Step(loads);
  const WholeSkinTracker::Numbers& n = whole_skin_->numbers();
  const double values[] = {
      n.root_force,   n.root_taxels, n.peak_share,         n.log_spread,
      n.force_rate,   n.taxels_rate, n.peak_share_rate,    n.spread_rate,
      n.change_short, n.change_long, n.change_since_onset, n.log_travel};
  static_assert(std::size(values) == kFirstEmbeddingCue - kFirstWholeSkinCue);
  std::ranges::copy(values, &state_.values[kFirstWholeSkinCue]);
}

void CueTracker::StepLevels(const FeatureVector& x, double peak_force) {
  State& s = state_;
  const double weight = Weight(smooth_window_);
  for (int i = 0; i < kFeatureCount; ++i) s.smooth[i].Step(x[i], weight);
  s.peak.Step(peak_force, weight);
  const double area = s.smooth[kA].value;
  const bool settled = static_cast<double>(s.frames) > settled_frames_;
  s.first_area = settled ? std::min(s.first_area, area) : area;
  s.largest_force = std::max(s.largest_force, s.smooth[kF].value);
}

void CueTracker::StepSprings(const FeatureVector& x, double weight) {
  State& s = state_;
  s.contact.Step(x, weight);
  s.force_motion.Step(x[kF] * x[kM], weight);
  s.motion_motion.Step(x[kM] * x[kM], weight);
  s.force_force.Step(x[kF] * x[kF], weight);
  const double force_motion =
      std::max(s.force_motion.value, kForceFloor * kMotionFloor);
  const double motion_motion =
      std::max(s.motion_motion.value, kMotionFloor * kMotionFloor);
  // Compares the ratios without a division.
  if (s.frames == 1 || force_motion * s.stiffest_motion_motion >
                           s.stiffest_force_motion * motion_motion) {
    s.stiffest_force_motion = force_motion;
    s.stiffest_motion_motion = motion_motion;
  }
}

void CueTracker::StepRoughness(const FeatureVector& x, double weight) {
  State& s = state_;
  for (int i = 0; i < kFeatureCount; ++i) {
    const double change = s.frames == 1 ? 0 : x[i] - s.last[i];
    s.roughness[i].Step(change * change, weight);
  }
  s.last = x;
}

void CueTracker::StepTremor(double force) {
  State& s = state_;
  const double change = s.frames == 1 ? 0 : force - s.last_force;
  const double turn = s.frames <= 2 ? 0 : change - s.last_change;
  const auto step = [&](Tremor& tremor, double weight) {
    tremor.level.Step(force, weight);
    tremor.change.Step(change * change, weight);
    tremor.turn.Step(turn * turn, weight);
  };
  step(s.short_tremor, Weight(short_window_));
  step(s.long_tremor, Weight(long_window_));
  s.last_force = force;
  s.last_change = change;
}

void CueTracker::StepSpread(const LoadSpread& spread) {
  const double weight = Weight(smooth_window_);
  state_.row_spread.Step(spread.rows, weight);
  state_.column_spread.Step(spread.columns, weight);
}

void CueTracker::Derive() {
  state_.derived = true;
  if (Has(kLevelCues)) DeriveLevels();
  if (Has(kSpringCues)) DeriveSprings();
  if (Has(kShortWindowCues)) {
    DeriveWindow(state_.short_window, Cue::kStiffnessShort);
  }
  if (Has(kLongWindowCues)) {
    DeriveWindow(state_.long_window, Cue::kStiffnessLong);
  }
  if (Has(kRoughnessCues)) DeriveRoughness();
  if (Has(kTremorCues)) {
    DeriveTremor(state_.short_tremor, Cue::kForceTremorShort);
    DeriveTremor(state_.long_tremor, Cue::kForceTremorLong);
  }
  if (Has(kSpreadCues)) DeriveSpread();
}

void CueTracker::DeriveLevels() {
  const State& s = state_;
  const double area = s.smooth[kA].value;
  const double log_force = Log(s.smooth[kF].value, kForceFloor);
  const double log_area = Log(area, kAreaFloor);
  const double log_motion = Log(s.smooth[kM].value, kMotionFloor);
  const double log_time =
      std::log(static_cast<double>(s.frames_since_onset) / sample_rate_hz_);
  Set(Cue::kLogPeak, Log(s.peak.value, kForceFloor));
  Set(Cue::kLogForce, log_force);
  Set(Cue::kLogArea, log_area);
  Set(Cue::kLogMotion, log_motion);
  Set(Cue::kLogTime, log_time);
  Set(Cue::kLogSpeed, log_motion - log_time);
  Set(Cue::kLogStiffness, log_force - log_motion);

  Set(Cue::kLogFirstArea, Log(s.first_area, kAreaFloor));
  Set(Cue::kAreaGrowth,
      SignedLog(Ratio(area - s.first_area, std::max(s.first_area, kAreaFloor)),
                kAreaKnee));
  const double log_largest = Log(s.largest_force, kForceFloor);
  Set(Cue::kLogLargestForce, log_largest);
  Set(Cue::kForceDrop, log_force - log_largest);
  Set(Cue::kLogDrag, log_force - 1.5 * log_area);
}

void CueTracker::DeriveSprings() {
  const State& s = state_;
  Set(Cue::kLogSpring,
      Log(s.force_motion.value, kForceFloor * kMotionFloor) -
          Log(s.motion_motion.value, kMotionFloor * kMotionFloor));
  Set(Cue::kLogStiffestSpring,
      std::log(s.stiffest_force_motion) - std::log(s.stiffest_motion_motion));
  Set(Cue::kLogSpringMisfit,
      Misfit(s.force_motion.value, s.motion_motion.value, s.force_force.value));

  const Moments& all = s.contact;
  Set(Cue::kLogSlope, Log(all.variance[kF], kForceFloor * kForceFloor) -
                          Log(all.force_motion, kForceFloor * kMotionFloor));
  Set(Cue::kLogSlopeMisfit,
      Misfit(all.force_motion, all.variance[kM], all.variance[kF]));
}

void CueTracker::DeriveWindow(const Moments& window, Cue stiffness) {
  auto set = [&](int place, double value) {
    state_.values[static_cast<int>(stiffness) + place] = value;
  };
  auto ripple = [&](int feature, double floor) {
    const double mean = std::max(std::abs(window.mean[feature]), floor);
    const double relative = window.variance[feature] / (mean * mean);
    return 0.5 * std::log(relative + kRippleFloor * kRippleFloor);
  };
  const auto slope = [&](double product, int feature) {
    const double rest = kRest * window.mean[feature];
    const double variance = window.variance[feature];
    return variance > rest * rest ? product / variance : 0;
  };
  set(0, SignedLog(slope(window.force_motion, kM), kStiffnessKnee));
  set(1, ripple(kF, kForceFloor));
  set(2, ripple(kM, kMotionFloor));
  set(3, ripple(kA, kAreaFloor));
  set(4, SignedLog(slope(window.force_area, kF) * window.mean[kF] /
                       std::max(window.mean[kA], kAreaFloor),
                   kAreaKnee));
}

void CueTracker::DeriveRoughness() {
  constexpr Cue kCue[] = {Cue::kForceRoughness, Cue::kAreaRoughness,
                          Cue::kMotionRoughness};
  constexpr double kFloor[] = {kForceFloor, kAreaFloor, kMotionFloor};
  for (int i = 0; i < kFeatureCount; ++i) {
    // Roughness is far smaller than the level.
    Set(kCue[i], 0.5 * std::log(state_.roughness[i].value +
                                kFloor[i] * kFloor[i] * kRippleFloor));
  }
}

void CueTracker::DeriveTremor(const Tremor& window, Cue tremor) {
  const double mean = std::max(std::abs(window.level.value), kForceFloor);
  const double rest = kRest * mean * (kRest * mean);
  const double change = window.change.value;
  state_.values[static_cast<int>(tremor)] =
      0.5 * std::log(change / (mean * mean) + kRippleFloor * kRippleFloor);
  state_.values[static_cast<int>(tremor) + 1] =
      0.5 * std::log((window.turn.value + rest) / (change + rest));
}

void CueTracker::DeriveSpread() {
  constexpr double kFloor = kSpreadFloor * kSpreadFloor;
  Set(Cue::kLogRowSpread, 0.5 * Log(state_.row_spread.value, kFloor));
  Set(Cue::kLogColumnSpread, 0.5 * Log(state_.column_spread.value, kFloor));
}

}  // namespace tactus
