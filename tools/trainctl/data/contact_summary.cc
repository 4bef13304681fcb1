#include "tools/trainctl/data/contact_summary.h"

#include <algorithm>
#include <cmath>

#include "core/contacts/labelled_contact.h"
#include "core/data/trial_loads.h"
#include "core/features/contact_time.h"
#include "core/features/contact_tracker.h"

namespace tactus::internal::client {
namespace {

// Enough for percentiles of noise.
constexpr size_t kMaxIdleValues = 2'000'000;

double Percentile(std::vector<double> values, double fraction) {
  const auto place = std::min(
      static_cast<size_t>(fraction * static_cast<double>(values.size())),
      values.size() - 1);
  const auto at = values.begin() + static_cast<ptrdiff_t>(place);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// The tenth, the median and the ninetieth of a hundred trials.
Json Spread(const std::vector<double>& values) {
  if (values.empty()) return nullptr;
  return {{"p10", Percentile(values, 0.1)},
          {"median", Percentile(values, 0.5)},
          {"p90", Percentile(values, 0.9)}};
}

}  // namespace

void ContactSummary::CountTouched(std::span<const float> taxels,
                                  const SkinLayout& layout) {
  touched_.resize(std::max(touched_.size(), taxels.size()), 0);
  ++frames_;
  for (size_t i = 0; i < taxels.size(); ++i) {
    touched_[i] += taxels[i] >= layout.contact_threshold;
  }
}

void ContactSummary::KeepIdle(std::span<const float> taxels,
                              const SkinLayout& layout) {
  ++idle_frames_;
  if (idle_.size() + taxels.size() > kMaxIdleValues) return;
  for (size_t i = 0; i < taxels.size(); ++i) {
    if (layout.mask.empty() || layout.mask[i] != 0) idle_.push_back(taxels[i]);
  }
}

absl::Status ContactSummary::Add(const Trial& trial, const SkinLayout& layout) {
  ++trials_;
  ContactTracker tracker(layout, {.sample_rate_hz = trial.sample_rate_hz,
                                  .release_after_s = kNeverReleased,
                                  .load_profile = false});
  TrialLoads loads(trial.taxels, layout);
  size_t onset = 0;
  size_t last_touched = 0;
  size_t longest_loss = 0;
  double peak = 0;
  double motion = 0;
  double area = 0;
  double regions = 0;
  double touched = 0;
  double load = 0;
  double change = 0;
  std::vector<float> taxels(layout.taxels(), 0);
  std::vector<float> before(taxels.size(), 0);
  for (size_t t = 0; t < trial.taxels.frames(); ++t) {
    before.swap(taxels);
    std::ranges::copy(loads.Frame(t), taxels.begin());
    CountTouched(taxels, layout);
    FrameView frame{.taxels = loads.values()};
    if (!trial.poses.empty()) frame.pose = &trial.poses[t];
    const FrameFeatures& features = tracker.Step(frame);
    if (tracker.state() != ContactState::kInContact) {
      KeepIdle(taxels, layout);
      continue;
    }
    if (tracker.onset()) onset = last_touched = t;
    if (!features.touched) continue;
    longest_loss = std::max(longest_loss, t - last_touched);
    last_touched = t;
    peak = std::max(peak, features.max_force);
    motion = std::max(motion, features.motion_m);
    area += features.area_taxels;
    regions += features.region_count;
    ++touched;
    if (tracker.onset()) continue;
    for (size_t i = 0; i < taxels.size(); ++i) {
      load += taxels[i];
      change += std::abs(taxels[i] - before[i]);
    }
  }
  if (touched == 0) return absl::OkStatus();
  ++felt_;
  const double rate = trial.sample_rate_hz;
  onset_s_.push_back(static_cast<double>(onset) / rate);
  contact_s_.push_back(ContactSeconds(last_touched - onset + 1, rate));
  peak_.push_back(peak);
  taxels_.push_back(area / touched);
  regions_.push_back(regions / touched);
  motion_mm_.push_back(1000 * motion);
  if (load > 0) change_.push_back(change / load);
  // Neighbouring touched frames are no loss.
  loss_s_.push_back(
      static_cast<double>(longest_loss > 1 ? longest_loss - 1 : 0) / rate);
  return absl::OkStatus();
}

Json ContactSummary::ToJson() const {
  Json idle = nullptr;
  if (!idle_.empty()) {
    idle = {{"frames", idle_frames_},
            {"median", Percentile(idle_, 0.5)},
            {"p99", Percentile(idle_, 0.99)},
            {"p99.9", Percentile(idle_, 0.999)},
            {"largest", *std::max_element(idle_.begin(), idle_.end())}};
  }
  // A taxel that is nearly always touched is broken, or its baseline is wrong.
  constexpr double kAlways = 0.99;
  Json always = Json::array();
  Json never = Json::array();
  for (size_t i = 0; i < touched_.size(); ++i) {
    if (touched_[i] == 0) never.push_back(i);
    if (static_cast<double>(touched_[i]) >=
        kAlways * static_cast<double>(frames_)) {
      always.push_back(i);
    }
  }
  return {{"felt", felt_},
          {"never_felt", trials_ - felt_},
          {"taxels_always_touched", always},
          {"taxels_never_touched", never},
          {"idle_before_onset", idle},
          {"onset_s", Spread(onset_s_)},
          {"contact_s", Spread(contact_s_)},
          {"largest_value", Spread(peak_)},
          {"taxels_of_largest_region", Spread(taxels_)},
          {"regions", Spread(regions_)},
          {"motion_mm", Spread(motion_mm_)},
          {"change_per_frame", Spread(change_)},
          {"longest_loss_of_touch_s", Spread(loss_s_)}};
}

}  // namespace tactus::internal::client
