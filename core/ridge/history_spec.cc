#include "core/ridge/history_spec.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
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

int HistoryBlock(int rows, int columns) {
  HistorySpec spec;
  spec.rows = rows;
  spec.columns = columns;
  while (spec.cells() > kMaxHistoryCells) ++spec.block;
  return spec.block;
}

absl::Status Validate(const HistorySpec& spec) {
  if (spec.rows < 1 || spec.columns < 1 ||
      spec.rows > limits::kMaxTaxels / spec.columns) {
    return InvalidModel("rows and columns of the history",
                        absl::StrCat(spec.rows, " x ", spec.columns),
                        absl::StrCat("1 to ", limits::kMaxTaxels, " taxels"));
  }
  if (spec.block != HistoryBlock(spec.rows, spec.columns)) {
    return InvalidModel("block of the history", spec.block,
                        absl::StrCat(HistoryBlock(spec.rows, spec.columns)));
  }
  for (const float scale : spec.scale) {
    // Written so that a NaN fails.
    if (!(scale > 0 && scale <= limits::kMaxSignal)) {
      return InvalidModel(
          "scale of the history", scale,
          absl::StrCat("above 0, at most ", limits::kMaxSignal));
    }
  }
  constexpr size_t kMixed = size_t{kHistoryViews} * kMiniKernels * kMiniMixed;
  TACTUS_RETURN_IF_ERROR(
      CheckSize("mixed channels", spec.mixed_channel.size(), kMixed));
  TACTUS_RETURN_IF_ERROR(
      CheckSize("mixed weights", spec.mixed_weight.size(), kMixed));
  TACTUS_RETURN_IF_ERROR(CheckSize("thresholds", spec.threshold.size(),
                                   size_t{kHistoryViews} * kMiniDilationCount *
                                       kMiniThresholds * kMiniKernels));
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
