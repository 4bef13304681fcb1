// What a watched job shows on a terminal.
#include "tools/trainctl/remote/job_display.h"

#include <sstream>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(JobDisplayTest, ATerminalHasOneLine) {
  std::ostringstream out;
  double now = 5;
  JobDisplay display(out, /*terminal=*/true, [&] { return now; });
  v1::Operation job;
  job.set_name("operations/7");
  job.set_state(v1::Operation::STATE_RUNNING);
  job.mutable_progress()->set_phase("train LSTMs");
  job.mutable_progress()->set_fraction(0.5);
  job.mutable_progress()->set_elapsed_ms(65'000);
  job.mutable_progress()->set_remaining_ms(30'000);
  std::vector<v1::LearningPoint> points(8);
  for (int i = 0; i < 8; ++i) {
    points[i].set_phase("train LSTMs");
    points[i].set_part("1");
    points[i].set_iteration(i + 1);
    points[i].set_loss(8 - i);
  }
  display.Update(job, points);
  EXPECT_EQ(out.str(),
            "\rtrain LSTMs  [#####     ]  50 %  1:05 elapsed, 0:30 left  "
            "█▇▆▅▄▃▂▁ 1");
  // Another part has another curve.
  now = 6;
  points.resize(1);
  points[0].set_part("2");
  display.Update(job, points);
  EXPECT_THAT(out.str(), ::testing::EndsWith("▁ 8       "));
  display.Clear();
  EXPECT_THAT(out.str(), Not(HasSubstr("\n")));
}

}  // namespace
}  // namespace tactus::internal::client
