#include "client/drivers/calibration/tare.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/drivers/calibration/taxel_noise.h"
#include "core/base/errors.h"

namespace tactus::internal::client {
namespace {

constexpr size_t kParts = 4;
constexpr double kTouchDeviations = 6;
constexpr double kTouchSteps = 3;
constexpr double kOutstandingDeviations = 10;
constexpr double kOutstandingSteps = 8;

// Largest difference between the means of the parts of a series.
double RangeOfParts(const std::vector<float>& series) {
  double least = 0;
  double most = 0;
  for (size_t part = 0; part < kParts; ++part) {
    const size_t begin = part * series.size() / kParts;
    const size_t end = (part + 1) * series.size() / kParts;
    double sum = 0;
    for (size_t t = begin; t < end; ++t) sum += series[t];
    const double mean = sum / static_cast<double>(end - begin);
    least = part == 0 ? mean : std::min(least, mean);
    most = part == 0 ? mean : std::max(most, mean);
  }
  return most - least;
}

absl::Status Touched(size_t taxel, absl::string_view why) {
  return InvalidTrainingData(absl::StrCat("the skin is touched: taxel ", taxel,
                                          " ", why, ", or mask the taxel"));
}

absl::Status CompareParts(const IdleFrames& idle) {
  const std::vector<double> noise = StepNoise(idle);
  for (size_t i = 0; i < idle.taxels(); ++i) {
    if (!idle.valid(i)) continue;
    const double range = RangeOfParts(idle.Series(i));
    if (range > kTouchDeviations * noise[i] &&
        range > kTouchSteps * idle.resolution()) {
      return Touched(
          i, absl::StrFormat("changed by %.3g, and its noise is %.3g; take "
                             "everything off the skin",
                             range, noise[i]));
    }
  }
  return absl::OkStatus();
}

absl::Status CompareWith(const EarlierBaseline& before, const IdleFrames& idle,
                         const std::vector<double>& baseline) {
  std::vector<double> rises;
  for (size_t i = 0; i < idle.taxels(); ++i) {
    if (idle.valid(i)) rises.push_back(baseline[i] - before.baseline[i]);
  }
  const double common = MedianOf(rises);
  for (size_t i = 0; i < idle.taxels(); ++i) {
    const double rise = baseline[i] - before.baseline[i] - common;
    if (idle.valid(i) && rise > before.contact_threshold[i]) {
      return Touched(
          i, absl::StrFormat(
                 "is %.3g above its baseline in the calibration, beyond the "
                 "%.3g of the whole skin; take everything off the skin, or "
                 "calibrate again",
                 rise, common));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<double>> Tare(const IdleFrames& idle,
                                         const EarlierBaseline* before) {
  if (idle.frames() < kMinTareFrames) {
    return InvalidConfig("frames of a tare", idle.frames(),
                         absl::StrCat(kMinTareFrames, " or more"));
  }
  if (const absl::Status status = CompareParts(idle); !status.ok()) {
    return status;
  }
  std::vector<double> baseline(idle.taxels());
  for (size_t t = 0; t < idle.frames(); ++t) {
    const auto frame = idle.Frame(t);
    for (size_t i = 0; i < idle.taxels(); ++i) baseline[i] += frame[i];
  }
  for (double& mean : baseline) mean /= static_cast<double>(idle.frames());
  if (before != nullptr) {
    const absl::Status status = CompareWith(*before, idle, baseline);
    if (!status.ok()) return status;
  }
  return baseline;
}

std::vector<int> OutstandingTaxels(const IdleFrames& idle,
                                   const std::vector<double>& baseline) {
  std::vector<double> valid;
  for (size_t i = 0; i < baseline.size(); ++i) {
    if (idle.valid(i)) valid.push_back(baseline[i]);
  }
  const double median = MedianOf(valid);
  for (double& value : valid) value = std::abs(value - median);
  const double level =
      std::max(kOutstandingDeviations * kDeviationsPerMedian * MedianOf(valid),
               kOutstandingSteps * idle.resolution());
  std::vector<int> found;
  for (size_t i = 0; i < baseline.size(); ++i) {
    if (idle.valid(i) && baseline[i] > median + level) {
      found.push_back(static_cast<int>(i));
    }
  }
  return found;
}

}  // namespace tactus::internal::client
