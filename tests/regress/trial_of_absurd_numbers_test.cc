// Times and signals of a trial had no upper bound: 1e300 s overflowed the
// replay's nanoseconds, 1e300 N the squares of the cues.
#include <limits>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/data/trial.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"

namespace tactus::internal {
namespace {

TEST(TrialOfAbsurdNumbersTest, IsRefused) {
  ASSERT_TRUE(Validate(FullTrial(1, 5), "a.h5").ok());
  for (const double value : {1e300, -1e300, 2 * limits::kMaxSignal,
                             std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN()}) {
    for (int f = 0; f < kFeatureCount; ++f) {
      Trial trial = FullTrial(1, 5);
      trial.signals[2][f] = value;
      EXPECT_EQ(ReasonOf(Validate(trial, "a.h5")), "TRIAL_FILE_INVALID");
    }
    Trial trial = FullTrial(1, 5);
    trial.time[value < 0 ? 0 : 4] = value;
    EXPECT_EQ(ReasonOf(Validate(trial, "a.h5")), "TRIAL_FILE_INVALID");
  }
}

TEST(TrialOfAbsurdNumbersTest, ClocksThatCountFrom1970AreFine) {
  Trial trial = FullTrial(1, 5);
  for (double& time : trial.time) time += 1.8e9;
  EXPECT_TRUE(Validate(trial, "a.h5").ok());
}

}  // namespace
}  // namespace tactus::internal
