#include "core/ridge/frame_views.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"

namespace tactus::internal {
namespace {

// Below it, the logarithm of the whole load says nothing.
constexpr float kLeastLoad = 1e-12F;

}  // namespace

int HistoryBlock(int rows, int columns) {
  FrameViews views;
  views.rows = rows;
  views.columns = columns;
  while (views.cells() > kMaxHistoryCells) ++views.block;
  return views.block;
}

absl::Status Validate(const FrameViews& views) {
  if (views.rows < 1 || views.columns < 1 ||
      views.rows > limits::kMaxTaxels / views.columns) {
    return InvalidModel("rows and columns of the history",
                        absl::StrCat(views.rows, " x ", views.columns),
                        absl::StrCat("1 to ", limits::kMaxTaxels, " taxels"));
  }
  if (views.block != HistoryBlock(views.rows, views.columns)) {
    return InvalidModel("block of the history", views.block,
                        absl::StrCat(HistoryBlock(views.rows, views.columns)));
  }
  for (const float scale : views.scale) {
    // Written so that a NaN fails.
    if (!(scale > 0 && scale <= limits::kMaxSignal)) {
      return InvalidModel(
          "scale of the history", scale,
          absl::StrCat("above 0, at most ", limits::kMaxSignal));
    }
  }
  return absl::OkStatus();
}

void ReadViews(const FrameViews& views, std::span<const TaxelLoad> loads,
               std::span<float> channels) {
  std::ranges::fill(channels, 0.0F);
  const auto cells = static_cast<size_t>(views.cells());
  const std::span<float> raw(channels.data(), cells + 1);
  const std::span<float> root(raw.data() + cells + 1, cells + 1);
  const std::span<float> shape(root.data() + cells + 1, cells + 1);
  float whole = 0;
  for (const TaxelLoad& load : loads) {
    const float value = load.root * load.root;
    raw[views.CellOf(load.taxel)] += value;
    whole += value;
  }
  raw[cells] = whole;
  const float per_whole = 1 / std::sqrt(std::max(whole, kLeastLoad));
  for (size_t i = 0; i <= cells; ++i) {
    root[i] = std::sqrt(raw[i]);
    shape[i] = root[i] * per_whole;
  }
  shape[cells] = std::log(std::max(whole, kLeastLoad));
  for (int view = 0; view < kFrameViews; ++view) {
    const float scale = views.scale[view];
    for (float& x : channels.subspan(view * (cells + 1), cells + 1)) x *= scale;
  }
}

}  // namespace tactus::internal
