#include "client/tools/common/measured_rate.h"

#include <cmath>

#include "absl/strings/str_format.h"
#include "client/tools/common/percentile.h"
#include "core/base/errors.h"

namespace tactus::client {
namespace {

constexpr double kMostDifference = 0.05;
constexpr double kPauseTimes = 3;

}  // namespace

void MeasuredRate::Add(const SkinFrame& frame) {
  if (last_ns_) {
    const double seconds =
        static_cast<double>(frame.capture_time_ns - *last_ns_) / 1e9;
    // Lost frames had their periods too.
    periods_s_.push_back(seconds /
                         static_cast<double>(frame.missing_before + 1));
  }
  last_ns_ = frame.capture_time_ns;
}

double MeasuredRate::hz() const {
  if (periods_s_.empty()) return 0;
  const double longest = kPauseTimes * Percentile(periods_s_, 0.5);
  double sum = 0;
  int count = 0;
  for (const double period : periods_s_) {
    if (period > longest) continue;
    sum += period;
    ++count;
  }
  return sum > 0 ? count / sum : 0;
}

absl::Status MeasuredRate::Check(double configured_hz) const {
  const double measured = hz();
  if (std::abs(measured / configured_hz - 1) <= kMostDifference) {
    return absl::OkStatus();
  }
  return InvalidConfig(
      "rate of the skin", absl::StrFormat("%.2f Hz, measured", measured),
      absl::StrFormat("within 5 %% of the configured %g Hz: give the right "
                      "--rate-hz or --period-ms",
                      configured_hz));
}

}  // namespace tactus::client
