#include "core/ridge/frame_views.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/limits_skin.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

// Below it, the logarithm of the whole load says nothing.
constexpr float kLeastLoad = 1e-12F;
// Those of three axes of signed values.
constexpr int kMaxPlanes = 6;
constexpr size_t kMaxAuxiliary = limits::kMaxAuxiliaryTaxels * kMaxPlanes;

absl::Status CheckScales(std::span<const float> scales) {
  for (const float scale : scales) {
    // Written so that a NaN fails.
    if (!(scale > 0 && scale <= limits::kMaxSignal)) {
      return InvalidModel(
          "scale of the history", scale,
          absl::StrCat("above 0, at most ", limits::kMaxSignal));
    }
  }
  return absl::OkStatus();
}

}  // namespace

int HistoryBlock(const TaxelShape& shape) {
  FrameViews views;
  views.rows = shape.rows;
  views.columns = shape.columns;
  views.planes = shape.planes;
  const int room = kMaxHistoryCells - shape.auxiliary;
  while (views.block < std::max(shape.rows, shape.columns) &&
         views.PlaneCells() > room) {
    ++views.block;
  }
  return views.block;
}

absl::Status Validate(const FrameViews& views) {
  if (views.rows < 1 || views.columns < 1 ||
      views.rows > limits::kMaxTaxels / views.columns) {
    return InvalidModel("rows and columns of the history",
                        absl::StrCat(views.rows, " x ", views.columns),
                        absl::StrCat("1 to ", limits::kMaxTaxels, " taxels"));
  }
  if (views.planes < 0 || views.planes > kMaxPlanes ||
      views.auxiliary_scale.size() > kMaxAuxiliary) {
    return InvalidModel(
        "planes and auxiliary components of the history",
        absl::StrCat(views.planes, " and ", views.auxiliary_scale.size()),
        absl::StrCat("at most ", kMaxPlanes, " and ", kMaxAuxiliary));
  }
  const int block = HistoryBlock(views.shape());
  if (views.block != block) {
    return InvalidModel("block of the history", views.block,
                        absl::StrCat(block));
  }
  TACTUS_RETURN_IF_ERROR(CheckScales(views.scale));
  return CheckScales(views.auxiliary_scale);
}

void ReadViews(const FrameViews& views, std::span<const TaxelLoad> loads,
               std::span<float> channels) {
  std::ranges::fill(channels, 0.0F);
  const auto cells = static_cast<size_t>(views.cells());
  const auto planes = static_cast<size_t>(views.PlaneCells());
  const std::span<float> raw(channels.data(), cells + 1);
  const std::span<float> root(raw.data() + cells + 1, cells + 1);
  const std::span<float> shape(root.data() + cells + 1, cells + 1);
  const auto taxels = static_cast<uint32_t>(views.rows * views.columns);
  const auto total = static_cast<uint32_t>(views.shape().total());
  float whole = 0;
  for (const TaxelLoad& load : loads) {
    if (load.taxel >= total) break;
    const float value = load.root * load.root;
    raw[views.CellOf(load.taxel)] += value;
    if (load.taxel < taxels) whole += value;
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
  for (size_t i = planes; i < cells; ++i) {
    const float scale = views.auxiliary_scale[i - planes];
    raw[i] *= scale / views.scale[0];
    root[i] *= std::sqrt(scale) / views.scale[1];
    shape[i] = root[i];
  }
}

}  // namespace tactus::internal
