// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <span>
#include <vector>

#include "core/base/status_macros.h"
#include "core/features/feature.h"
#include "core/ridge/fit_ridge.h"
#include "core/ridge/history_kernels.h"
#include "core/ridge/mini_kernels.h"
#include "core/ridge/ridge.h"
#include "core/ridge/touch_history.h"

namespace tactus::internal::examples {

using Contact = std::vector<ContactSample>;

static absl::Status FitRidgeExample(std::span<const RidgeSample> samples) {
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

static void TouchHistoryExample(const HistorySpec& spec, const Contact& contact,
                                std::span<float> numbers) {
#include "core/ridge/touch_history.h.inc"
}

}  // namespace tactus::internal::examples
