#include "tools/common/measured_rate.h"

#include <cmath>
#include <limits>

#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "tools/common/percentile.h"

namespace tactus::internal::client {
namespace {

constexpr double kMostDifference = 0.05;
// Shortest and longest period that counts, as fractions of the median.
constexpr double kLeastPeriod = 0.5;
constexpr double kMostPeriod = 1.5;
constexpr double kPause = 5;
constexpr double kMost = 0.6;

// Frames per second of the periods within limits, and how many those are.
struct Mean {
  double hz = 0;
  size_t periods = 0;
};

Mean MeanWithin(const std::vector<double>& periods_s, double least,
                double most) {
  double sum = 0;
  size_t count = 0;
  for (const double period : periods_s) {
    if (period < least || period > most) continue;
    sum += period;
    ++count;
  }
  return {sum > 0 ? static_cast<double>(count) / sum : 0, count};
}

}  // namespace

void MeasuredRate::Add(const SkinFrame& frame) {
  if (last_ns_) {
    periods_s_.push_back(
        static_cast<double>(frame.capture_time_ns - *last_ns_) / 1e9);
  }
  last_ns_ = frame.capture_time_ns;
}

double MeasuredRate::hz() const {
  if (periods_s_.empty()) return 0;
  const double median = Percentile(periods_s_, 0.5);
  const Mean usual =
      MeanWithin(periods_s_, kLeastPeriod * median, kMostPeriod * median);
  if (static_cast<double>(usual.periods) >=
      kMost * static_cast<double>(periods_s_.size())) {
    return usual.hz;
  }
  const double mean_s =
      1 / MeanWithin(periods_s_, 0, std::numeric_limits<double>::max()).hz;
  return MeanWithin(periods_s_, 0, kPause * mean_s).hz;
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

}  // namespace tactus::internal::client
