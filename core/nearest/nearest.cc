#include "core/nearest/nearest.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/ridge/history_kernels.h"

namespace tactus::internal {
namespace {

// Sums of squares of larger numbers would not be finite.
constexpr float kLargest = 1e9F;
// A sample is left as soon as so many of its numbers show that it is farther
// than another one of its class.
constexpr size_t kChunk = 512;

absl::Status CheckSize(absl::string_view name, size_t got, size_t want) {
  if (got == want) return absl::OkStatus();
  return InvalidModel(absl::StrCat(name, " of the nearest neighbours"), got,
                      absl::StrCat(want));
}

absl::Status CheckSmall(absl::string_view name,
                        const std::vector<float>& numbers) {
  for (const float number : numbers) {
    // Written so that a NaN fails.
    if (!(std::abs(number) <= kLargest)) {
      return InvalidModel(absl::StrCat(name, " of the nearest neighbours"),
                          number, absl::StrCat("within ", kLargest, " of 0"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status Validate(const Nearest& nearest) {
  TACTUS_RETURN_IF_ERROR(Validate(nearest.views));
  if (nearest.view < 0 || nearest.view >= kFrameViews) {
    return InvalidModel("view of the nearest neighbours", nearest.view,
                        absl::StrCat("0 to ", kFrameViews - 1));
  }
  const size_t numbers = nearest.numbers();
  TACTUS_RETURN_IF_ERROR(CheckSize("gains", nearest.gain.size(), numbers));
  TACTUS_RETURN_IF_ERROR(CheckSize("samples", nearest.sample.size(),
                                   numbers * nearest.label.size()));
  TACTUS_RETURN_IF_ERROR(CheckSmall("gain", nearest.gain));
  TACTUS_RETURN_IF_ERROR(CheckSmall("number", nearest.sample));
  std::vector<bool> seen(std::max(nearest.classes, 0));
  for (const uint32_t label : nearest.label) {
    if (label >= seen.size()) {
      return InvalidModel("class of a nearest neighbour", label,
                          absl::StrCat("below ", nearest.classes));
    }
    seen[label] = true;
  }
  if (std::ranges::find(seen, false) != seen.end()) {
    return InvalidModel("classes of the nearest neighbours",
                        std::ranges::count(seen, true),
                        absl::StrCat(nearest.classes));
  }
  return absl::OkStatus();
}

ViewStretches::ViewStretches(const FrameViews* views, int view)
    : views_(views),
      view_(view),
      stretches_(views->channels()),
      channels_(static_cast<size_t>(views->channels()) * kFrameViews) {}

void ViewStretches::Step(std::span<const TaxelLoad> loads) {
  ReadViews(*views_, loads, channels_);
  const auto count = static_cast<size_t>(views_->channels());
  const float* const values = channels_.data() + view_ * count;
  const std::span<double> sums = stretches_.sums();
  for (size_t i = 0; i < count; ++i) {
    sums[i] += static_cast<double>(values[i]);
  }
  stretches_.Step();
}

NearestScorer::NearestScorer(const Nearest* nearest)
    : nearest_(nearest),
      stretches_(&nearest->views, nearest->view),
      numbers_(nearest->numbers()) {}

void NearestScorer::Score(std::span<double> scores) {
  stretches_.Write(numbers_);
  const size_t count = numbers_.size();
  for (size_t i = 0; i < count; ++i) {
    numbers_[i] =
        std::clamp(numbers_[i] * nearest_->gain[i], -kLargest, kLargest);
  }
  std::ranges::fill(scores, -std::numeric_limits<double>::infinity());
  const std::span<const float> numbers(numbers_);
  const std::span<const float> samples(nearest_->sample);
  for (size_t s = 0; s < nearest_->label.size(); ++s) {
    double& score = scores[nearest_->label[s]];
    double distance = 0;
    for (size_t i = 0; i < count && -distance > score; i += kChunk) {
      const size_t size = std::min(kChunk, count - i);
      distance += static_cast<double>(SquaredDistance(
          numbers.subspan(i, size), samples.subspan(s * count + i, size)));
    }
    score = std::max(score, -distance);
  }
  for (double& score : scores) score = -std::log(kEqualDistance - score);
}

}  // namespace tactus::internal
