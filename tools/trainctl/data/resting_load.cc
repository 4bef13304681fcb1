#include "tools/trainctl/data/resting_load.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "core/data/trial_loads.h"

namespace tactus::internal::client {

void RestingLoad::Add(const Trial& trial) {
  if (!trial.skin || trial.taxels.frames() == 0) return;
  const SkinLayout& skin = *trial.skin;
  TrialLoads loads(trial.taxels, skin);
  const std::span<const float> first = loads.Frame(0);
  taxels_.assign(first.begin(), first.end());
  if (!skin.mask.empty()) {
    size_t kept = 0;
    for (size_t i = 0; i < skin.mask.size(); ++i) {
      if (skin.mask[i] != 0) taxels_[kept++] = taxels_[i];
    }
    taxels_.resize(kept);
  }
  ++trials_;
  if (taxels_.empty()) return;
  const auto middle =
      taxels_.begin() + static_cast<ptrdiff_t>(taxels_.size() / 2);
  std::nth_element(taxels_.begin(), middle, taxels_.end());
  if (*middle < skin.contact_threshold) return;
  if (loaded_++ > 0) return;
  threshold_ = skin.contact_threshold;
  median_ = *middle;
}

std::string RestingLoad::Text() const {
  if (loaded_ == 0 || 10 * loaded_ < 9 * trials_) return "";
  return absl::StrCat(
      "trainctl: ", loaded_, " of ", trials_,
      " trials begin with half of the taxels in touch (median ", median_,
      ", contact_threshold ", threshold_,
      "). If nothing touches the skin there, it rests above the threshold: say "
      "\"baseline\": \"from idle frames\" and \"idle_frames\" in skin.json, "
      "or a higher threshold\n");
}

}  // namespace tactus::internal::client
