#include "core/ridge/history_spec.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

absl::Status CheckSize(absl::string_view name, size_t got, size_t want) {
  if (got == want) return absl::OkStatus();
  return InvalidModel(absl::StrCat(name, " of the history"), got,
                      absl::StrCat(want));
}

absl::Status CheckSmall(absl::string_view name,
                        const std::vector<float>& numbers) {
  // Sums of products of larger numbers would not be finite.
  constexpr float kLargest = 1e9F;
  for (const float number : numbers) {
    // Written so that a NaN fails.
    if (!(std::abs(number) <= kLargest)) {
      return InvalidModel(absl::StrCat(name, " of the history"), number,
                          absl::StrCat("within ", kLargest, " of 0"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status Validate(const HistorySpec& spec) {
  TACTUS_RETURN_IF_ERROR(Validate(static_cast<const FrameViews&>(spec)));
  const size_t any = spec.has_kernels() ? 1 : 0;
  const size_t mixed = any * kFrameViews * kMiniKernels * kMiniMixed;
  TACTUS_RETURN_IF_ERROR(
      CheckSize("mixed channels", spec.mixed_channel.size(), mixed));
  TACTUS_RETURN_IF_ERROR(
      CheckSize("mixed weights", spec.mixed_weight.size(), mixed));
  TACTUS_RETURN_IF_ERROR(CheckSize(
      "thresholds", spec.threshold.size(),
      any * kFrameViews * kMiniDilationCount * kMiniThresholds * kMiniKernels));
  for (const uint16_t channel : spec.mixed_channel) {
    if (channel >= spec.channels()) {
      return InvalidModel("mixed channel of the history", channel,
                          absl::StrCat("below ", spec.channels()));
    }
  }
  TACTUS_RETURN_IF_ERROR(CheckSmall("mixed weight", spec.mixed_weight));
  for (const float threshold : spec.threshold) {
    if (!std::isfinite(threshold)) {
      return InvalidModel("threshold of the history", threshold, "finite");
    }
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal
