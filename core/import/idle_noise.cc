#include "core/import/idle_noise.h"

#include <algorithm>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/data/trial_loads.h"
#include "core/skin/idle_thresholds.h"

namespace tactus::internal {
namespace {

constexpr size_t kMaxValues = 4'000'000;

}  // namespace

void IdleNoise::Keep(float value) {
  if (seen_++ % stride_ != 0) return;
  values_.push_back(value);
  if (values_.size() < kMaxValues) return;
  for (size_t i = 0; 2 * i < values_.size(); ++i) values_[i] = values_[2 * i];
  values_.resize((values_.size() + 1) / 2);
  stride_ *= 2;
}

void IdleNoise::Add(const Trial& trial) {
  const size_t frames = trial.taxels.frames();
  if (frames == 0) return;
  SkinLayout skin = trial.skin.value_or(SkinLayout());
  skin.rows = trial.taxels.rows;
  skin.columns = trial.taxels.columns;
  const auto size = static_cast<size_t>(skin.taxels());
  std::vector<size_t> taxels;
  for (size_t i = 0; i < size; ++i) {
    if (skin.mask.empty() || skin.mask[i] != 0) {
      taxels.push_back(i);
    }
  }
  TrialLoads loads(trial.taxels, skin);
  std::vector<float> values(frames * size);
  std::vector<double> sums(size, 0);
  float peak = 0;
  for (size_t t = 0; t < frames; ++t) {
    std::ranges::copy(loads.Frame(t), &values[t * size]);
    for (const size_t i : taxels) {
      peak = std::max(peak, values[t * size + i]);
      sums[i] += values[t * size + i];
    }
  }
  peaks_.push_back(peak);
  size_t idle_frames = frames;
  if (which_.frames > 0) {
    idle_frames = std::min<size_t>(frames, which_.frames);
  } else {
    std::stable_sort(taxels.begin(), taxels.end(),
                     [&](size_t a, size_t b) { return sums[a] < sums[b]; });
    taxels.resize(static_cast<size_t>(which_.taxels *
                                      static_cast<double>(taxels.size())));
  }
  for (size_t t = 0; t < idle_frames; ++t) {
    for (const size_t i : taxels) Keep(values[t * size + i]);
  }
}

absl::StatusOr<IdleEstimate> IdleNoise::Estimate() const {
  if (values_.empty()) {
    return InvalidTrainingData("there are no idle values of taxels");
  }
  IdleEstimate found;
  found.values = values_.size();
  found.median = IdleQuantile(values_, 0.5);
  found.percentile_999 = IdleQuantile(values_, kIdleFraction);
  found.largest = *std::max_element(values_.begin(), values_.end());
  found.peak = IdleQuantile(peaks_, 0.5);
  const IdleThresholds thresholds =
      ThresholdsAbove(found.median, found.percentile_999, found.peak / 50);
  found.margin = thresholds.margin;
  found.contact_threshold = thresholds.contact_threshold;
  found.onset_threshold = thresholds.onset_threshold;
  if (!(found.contact_threshold <= found.peak / 2) || found.peak == 0) {
    return InvalidTrainingData(absl::StrCat(
        "the idle values are not idle: their 99.9th percentile is ",
        found.percentile_999, " and the largest value of the median trial is ",
        found.peak,
        "; give fewer idle_frames, or idle_taxels if the recordings begin in "
        "contact"));
  }
  return found;
}

}  // namespace tactus::internal
