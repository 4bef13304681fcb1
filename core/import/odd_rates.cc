#include "core/import/odd_rates.h"

#include <algorithm>

#include "absl/strings/str_format.h"
#include "core/data/trial_id.h"
#include "core/import/rate_check.h"

namespace tactus::internal {

void OddRates::Add(const std::string& name, double stated_hz,
                   double measured_hz) {
  if (count_++ == 0) {
    first_ = name;
    stated_hz_ = stated_hz;
    least_hz_ = most_hz_ = measured_hz;
  }
  least_hz_ = std::min(least_hz_, measured_hz);
  most_hz_ = std::max(most_hz_, measured_hz);
}

void OddRates::Add(const Trial& trial) {
  const RateCheck check = CheckRate(trial.time, trial.sample_rate_hz);
  if (!check.remarkable) return;
  Add(TrialName(trial.id, trial.source), trial.sample_rate_hz,
      check.measured_hz);
}

std::string OddRates::Remark() const {
  return absl::StrFormat(
      "the times of %d trials have another rate than %g Hz: %.4g to %.4g Hz; "
      "the first is %s",
      count_, stated_hz_, least_hz_, most_hz_, first_);
}

}  // namespace tactus::internal
