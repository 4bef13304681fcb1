#include "core/taxels/skin_range.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/taxels/components.h"

namespace tactus::internal {
namespace {

// A fraction of the width of a taxel's range.
constexpr float kMargin = 0.5F;
// A fraction of the mean of the largest loads of all taxels.
constexpr float kLeastMargin = 0.1F;

}  // namespace

absl::Status Validate(const SkinRange& range, int taxels) {
  const auto count = static_cast<size_t>(taxels);
  if (range.least.size() != count || range.most.size() != count) {
    return InvalidModel(
        "numbers of the skin's range",
        absl::StrCat(range.least.size(), " and ", range.most.size()),
        absl::StrCat(taxels, " each, one per taxel"));
  }
  for (size_t i = 0; i < count; ++i) {
    // Written so that a NaN fails.
    if (!(range.least[i] >= 0 && range.least[i] <= range.most[i] &&
          std::isfinite(range.most[i]))) {
      return InvalidModel(absl::StrCat("range of taxel ", i),
                          absl::StrCat(range.least[i], " to ", range.most[i]),
                          "finite, from 0 or more upwards");
    }
  }
  return absl::OkStatus();
}

void ContactLoads::Reset() {
  frames_ = 0;
  std::ranges::fill(sum_, 0.0);
}

void ContactLoads::Step(std::span<const TaxelLoad> loads) {
  ++frames_;
  for (const TaxelLoad& load :
       WithoutComponents(loads, static_cast<int>(sum_.size()))) {
    sum_[load.taxel] += static_cast<double>(load.root) * load.root;
  }
}

SkinRangeWatch::SkinRangeWatch(const SkinRange* range)
    : range_(range), loads_(range->most.size()), differed_(range->most.size()) {
  double sum = 0;
  for (const float most : range->most) sum += most;
  least_margin_ =
      kLeastMargin *
      static_cast<float>(sum / static_cast<double>(range->most.size()));
  differing_.reserve(range->most.size());
}

float SkinRangeWatch::Distance(size_t taxel, float load) const {
  const float least = range_->least[taxel];
  const float most = range_->most[taxel];
  const float margin = kMargin * (most - least) + least_margin_;
  return std::max({least - margin - load, load - most - margin, 0.0F});
}

bool SkinRangeWatch::EndContact() {
  if (loads_.frames() == 0) return false;
  bool some = false;
  for (size_t i = 0; i < differed_.size(); ++i) {
    const bool differs = Distance(i, loads_.Mean(i)) > 0;
    differed_[i] = differs ? std::min<uint8_t>(differed_[i] + 1, kContacts) : 0;
    some |= differed_[i] == kContacts;
  }
  const bool tell = some && !told_;
  if (tell) {
    told_ = true;
    for (uint32_t i = 0; i < differed_.size(); ++i) {
      if (differed_[i] == kContacts) {
        differing_.push_back({i, loads_.Mean(i)});
      }
    }
    std::ranges::sort(differing_, std::greater<>(), [&](const Reading& taxel) {
      return Distance(taxel.taxel, taxel.load);
    });
  }
  loads_.Reset();
  return tell;
}

}  // namespace tactus::internal
