// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <span>
#include <vector>

#include "core/base/status_macros.h"
#include "core/features/feature.h"
#include "core/nearest/fit_nearest.h"
#include "core/nearest/nearest.h"
#include "core/ridge/fit_ridge.h"
#include "core/ridge/frame_views.h"
#include "core/ridge/history_kernels.h"
#include "core/ridge/history_sample.h"
#include "core/ridge/mini_kernels.h"
#include "core/ridge/ridge.h"
#include "core/ridge/stretches.h"
#include "core/ridge/touch_history.h"
#include "core/trees/fit_trees.h"
#include "core/trees/trees.h"

namespace tactus::internal::examples {

using Contact = std::vector<ContactSample>;

static void FrameViewsExample(const FrameViews& views,
                              const ContactSample& sample,
                              std::span<float> channels) {
#include "core/ridge/frame_views.h.inc"
}

static void HistorySampleExample(size_t frames, void step(size_t)) {
  size_t t = 0;
#include "core/ridge/history_sample.h.inc"
}

static absl::Status FitNearestExample(std::span<const HistorySample> samples) {
#include "core/nearest/fit_nearest.h.inc"
  return absl::OkStatus();
}

static void NearestExample(const Nearest& nearest, const Contact& contact,
                           std::span<double> scores) {
#include "core/nearest/nearest.h.inc"
}

static absl::Status FitTreesExample(std::span<const HistorySample> samples) {
#include "core/trees/fit_trees.h.inc"
  return absl::OkStatus();
}

static void TreesExample(const Trees& trees, const Contact& contact,
                         std::span<double> scores) {
#include "core/trees/trees.h.inc"
}

static absl::Status FitRidgeExample(std::span<const HistorySample> samples) {
#include "core/ridge/fit_ridge.h.inc"
  return absl::OkStatus();
}

static void HistoryKernelsExample(const std::vector<float>& values,
                                  size_t count, const ChannelSums& sums) {
#include "core/ridge/history_kernels.h.inc"
}

static void MiniKernelsExample(int j, const float* x) {
  float sum = 0;
#include "core/ridge/mini_kernels.h.inc"
}

static void RidgeExample(const Ridge& ridge, const Contact& contact,
                         std::span<double> scores) {
#include "core/ridge/ridge.h.inc"
}

static void StretchesExample(size_t channels, const float* frame,
                             std::span<float> numbers) {
#include "core/ridge/stretches.h.inc"
}

static void TouchHistoryExample(const HistorySpec& spec, const Contact& contact,
                                std::span<float> numbers) {
#include "core/ridge/touch_history.h.inc"
}

}  // namespace tactus::internal::examples
