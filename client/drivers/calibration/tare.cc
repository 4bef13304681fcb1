#include "client/drivers/calibration/tare.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/drivers/calibration/taxel_noise.h"
#include "client/drivers/calibration/touch_thresholds.h"
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

// " along x", or nothing on a skin of one axis.
std::string Along(const IdleFrames& idle, size_t value) {
  if (idle.axes() == 1) return "";
  return absl::StrCat(" along ", kAxisNames[value % idle.axes()]);
}

absl::Status Touched(size_t taxel, absl::string_view why) {
  return InvalidTrainingData(absl::StrCat("the skin is touched: taxel ", taxel,
                                          " ", why, ", or mask the taxel"));
}

absl::Status CompareParts(const IdleFrames& idle) {
  const std::vector<double> noise = StepNoise(idle);
  for (size_t i = 0; i < idle.values(); ++i) {
    if (!idle.valid(idle.TaxelOf(i))) continue;
    const double range = RangeOfParts(idle.Series(i));
    if (range > kTouchDeviations * noise[i] &&
        range > kTouchSteps * idle.resolution()) {
      return Touched(idle.TaxelOf(i),
                     absl::StrFormat("changed%s by %.3g, and its noise is "
                                     "%.3g; take everything off the skin",
                                     Along(idle, i), range, noise[i]));
    }
  }
  return absl::OkStatus();
}

absl::Status CompareWith(const Calibration& before, const IdleFrames& idle,
                         const std::vector<double>& baseline) {
  std::vector<double> rises(baseline.size());
  for (size_t i = 0; i < rises.size(); ++i) {
    rises[i] = baseline[i] - before.baseline[i];
  }
  const AxisVector common = AxisMedians(idle, rises);
  for (size_t i = 0; i < rises.size(); ++i) rises[i] -= common[i % idle.axes()];
  const TouchThresholds thresholds(before);
  for (size_t taxel = 0; taxel < idle.taxels(); ++taxel) {
    if (!idle.valid(taxel) || !(thresholds.Excess(taxel, rises) > 0)) continue;
    size_t most = idle.axes() * taxel;
    for (size_t i = most; i < idle.axes() * (taxel + 1); ++i) {
      if (std::abs(rises[i]) > std::abs(rises[most])) most = i;
    }
    return Touched(
        taxel,
        absl::StrFormat("is%s %.3g %s its baseline in the calibration, beyond "
                        "the %.3g of the whole skin; take everything off the "
                        "skin, or calibrate again",
                        Along(idle, most), std::abs(rises[most]),
                        rises[most] < 0 ? "below" : "above",
                        common[most % idle.axes()]));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<double>> Tare(const IdleFrames& idle,
                                         const Calibration* before) {
  if (idle.frames() < kMinTareFrames) {
    return InvalidConfig("frames of a tare", idle.frames(),
                         absl::StrCat(kMinTareFrames, " or more"));
  }
  if (const absl::Status status = CompareParts(idle); !status.ok()) {
    return status;
  }
  std::vector<double> baseline(idle.values());
  for (size_t t = 0; t < idle.frames(); ++t) {
    const auto frame = idle.Frame(t);
    for (size_t i = 0; i < baseline.size(); ++i) baseline[i] += frame[i];
  }
  for (double& mean : baseline) mean /= static_cast<double>(idle.frames());
  if (before != nullptr) {
    const absl::Status status = CompareWith(*before, idle, baseline);
    if (!status.ok()) return status;
  }
  return baseline;
}

std::vector<bool> OutstandingValues(const IdleFrames& idle,
                                    const std::vector<double>& baseline) {
  const AxisVector medians = AxisMedians(idle, baseline);
  std::vector<double> beside(baseline.size());
  for (size_t i = 0; i < beside.size(); ++i) {
    beside[i] = std::abs(baseline[i] - medians[i % idle.axes()]);
  }
  const AxisVector usual = AxisMedians(idle, beside);
  std::vector<bool> found(baseline.size());
  for (size_t i = 0; i < found.size(); ++i) {
    const size_t axis = i % idle.axes();
    const double level =
        std::max(kOutstandingDeviations * kDeviationsPerMedian * usual[axis],
                 kOutstandingSteps * idle.resolution());
    found[i] = idle.valid(idle.TaxelOf(i)) &&
               (baseline[i] > medians[axis] + level ||
                (idle.both_ways() && baseline[i] < medians[axis] - level));
  }
  return found;
}

std::vector<int> OutstandingTaxels(const IdleFrames& idle,
                                   const std::vector<double>& baseline) {
  const std::vector<bool> values = OutstandingValues(idle, baseline);
  std::vector<int> taxels;
  for (size_t i = 0; i < values.size(); ++i) {
    const auto taxel = static_cast<int>(idle.TaxelOf(i));
    if (values[i] && (taxels.empty() || taxels.back() != taxel)) {
      taxels.push_back(taxel);
    }
  }
  return taxels;
}

}  // namespace tactus::internal::client
