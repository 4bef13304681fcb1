#include "core/ridge/ridge.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/ridge/history_kernels.h"

namespace tactus::internal {
namespace {

// Sums of products of larger numbers would not be finite.
constexpr float kLargest = 1e9F;

absl::Status CheckNumbers(absl::string_view name,
                          const std::vector<float>& numbers, size_t want) {
  if (numbers.size() != want) {
    return InvalidModel(absl::StrCat(name, " of the ridge"), numbers.size(),
                        absl::StrCat(want));
  }
  for (const float number : numbers) {
    // Written so that a NaN fails.
    if (!(std::abs(number) <= kLargest)) {
      return InvalidModel(absl::StrCat(name, " of the ridge"), number,
                          absl::StrCat("within ", kLargest, " of 0"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status Validate(const Ridge& ridge) {
  TACTUS_RETURN_IF_ERROR(Validate(ridge.history));
  const size_t numbers = ridge.history.numbers();
  TACTUS_RETURN_IF_ERROR(CheckNumbers("offsets", ridge.offset, numbers));
  TACTUS_RETURN_IF_ERROR(CheckNumbers("gains", ridge.gain, numbers));
  TACTUS_RETURN_IF_ERROR(
      CheckNumbers("weights", ridge.weight, numbers * ridge.bias.size()));
  return CheckNumbers("biases", ridge.bias, ridge.bias.size());
}

RidgeScorer::RidgeScorer(const Ridge* ridge)
    : ridge_(ridge),
      history_(&ridge->history),
      numbers_(history_.LargestPart()) {}

void RidgeScorer::Score(std::span<double> scores) {
  for (size_t k = 0; k < scores.size(); ++k) {
    scores[k] = static_cast<double>(ridge_->bias[k]);
  }
  const std::span<const float> offset = ridge_->offset;
  const std::span<const float> gain = ridge_->gain;
  const std::span<const float> weight = ridge_->weight;
  size_t first = 0;
  for (int part = 0; part < history_.parts(); ++part) {
    const size_t count = history_.WritePart(part, numbers_);
    const std::span<float> numbers = std::span(numbers_).first(count);
    Standardise(numbers, offset.subspan(first, count),
                gain.subspan(first, count), kRidgeLimit, numbers);
    for (size_t k = 0; k < scores.size(); ++k) {
      scores[k] += static_cast<double>(
          DotProduct(numbers, weight.subspan(k * gain.size() + first, count)));
    }
    first += count;
  }
}

}  // namespace tactus::internal
