#include "core/import/rate_check.h"

#include <cmath>

#include "absl/strings/str_format.h"

namespace tactus::internal {
namespace {

// The times may be those of a computer, or of frames that were dropped.
constexpr double kRefusedDifference = 0.2;
// As a model's rate may differ at most.
constexpr double kRemarkedDifference = 0.05;

// Says if the times look like those of another unit.
std::string UnitAdvice(double ratio) {
  for (const double unit : {1e3, 1e6, 1e9, 1e-3, 1e-6, 1e-9}) {
    if (std::abs(ratio * unit - 1) > kRefusedDifference) continue;
    return absl::StrFormat(
        ". The times are %g times what they would be in seconds: if their unit "
        "is another, multiply \"time_scale_s\" of skin.json by %g",
        unit, 1 / unit);
  }
  return "";
}

// Names the longest time between two frames if the others have the stated rate.
std::string GapAdvice(const std::vector<double>& times, double stated_hz) {
  size_t before = 0;
  double longest = 0;
  for (size_t i = 1; i < times.size(); ++i) {
    if (times[i] - times[i - 1] <= longest) continue;
    longest = times[i] - times[i - 1];
    before = i;
  }
  const double rest_hz = static_cast<double>(times.size() - 2) /
                         (times.back() - times.front() - longest);
  if (!(std::abs(rest_hz / stated_hz - 1) <= kRefusedDifference)) return "";
  return absl::StrFormat(
      ". Frame %d comes %.4g s after the one before it, the others have the "
      "stated rate: make a recording of each part",
      before, longest);
}

}  // namespace

RateCheck CheckRate(const std::vector<double>& times, double stated_hz) {
  RateCheck check;
  if (times.size() < 2) return check;
  check.measured_hz =
      static_cast<double>(times.size() - 1) / (times.back() - times.front());
  const double ratio = check.measured_hz / stated_hz;
  const double difference = std::abs(ratio - 1);
  check.remarkable = difference > kRemarkedDifference;
  if (difference > kRefusedDifference) {
    check.error = absl::StrFormat(
        "is %g, but the times are those of %.4g frames a second", stated_hz,
        check.measured_hz);
    check.advice = UnitAdvice(ratio);
    if (check.advice.empty()) check.advice = GapAdvice(times, stated_hz);
  }
  return check;
}

}  // namespace tactus::internal
