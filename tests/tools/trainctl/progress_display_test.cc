#include "tools/trainctl/progress_display.h"

#include <sstream>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ProgressDisplayTest : public ::testing::Test {
 protected:
  std::ostringstream out_;
  double now_ = 0;
  const std::function<double()> clock_ = [this] { return now_; };
};

TEST_F(ProgressDisplayTest, TheFirstSecondIsQuiet) {
  for (bool terminal : {true, false}) {
    ProgressDisplay display(out_, terminal, clock_);
    now_ = 0.9;
    display.progress().Part("fit", 1).Add(0.5);
    EXPECT_EQ(out_.str(), "");
  }
}

TEST_F(ProgressDisplayTest, MayBeHidden) {
  HideProgress(true);
  ProgressDisplay display(out_, /*terminal=*/false, clock_);
  HideProgress(false);
  now_ = 5;
  display.progress().Part("fit", 1).Add(0.5);
  EXPECT_EQ(out_.str(), "");
}

TEST_F(ProgressDisplayTest, APipeHasOneLineAPhase) {
  ProgressDisplay display(out_, /*terminal=*/false, clock_);
  const Progress all = display.progress();
  for (const char* phase : {"fit", "calibrate"}) {
    for (int i = 0; i < 10; ++i) {
      now_ += 1;
      all.Part(phase, 0.5).Add(0.1);
    }
  }
  display.Clear();
  EXPECT_EQ(out_.str(), "trainctl: fit\ntrainctl: calibrate\n");
}

TEST_F(ProgressDisplayTest, ATerminalHasOneLineWithTheTimeLeft) {
  ProgressDisplay display(out_, /*terminal=*/true, clock_);
  const Progress fit = display.progress().Part("fit", 1);
  fit.Add(0);
  now_ = 30;
  fit.Part("inner", 0.5).Add(0.5);
  EXPECT_THAT(out_.str(), HasSubstr("\rfit  [##        ]  25 %, 1:30 left"));
  EXPECT_THAT(out_.str(), Not(HasSubstr("\n")));
  // Too soon to be shown.
  now_ = 30.1;
  fit.Add(0.25);
  EXPECT_THAT(out_.str(), Not(HasSubstr("50 %")));
  now_ = 40;
  fit.Add(0);
  EXPECT_THAT(out_.str(), HasSubstr("\rfit  [#####     ]  50 %, 0:40 left"));
  out_.str("");
  display.Clear();
  EXPECT_THAT(out_.str(), ::testing::MatchesRegex("\r *\r"));
}

TEST_F(ProgressDisplayTest, CountsWithoutTotalAreShown) {
  ProgressDisplay display(out_, /*terminal=*/true, clock_);
  now_ = 2;
  display.Count("import trials", 132);
  EXPECT_THAT(out_.str(), HasSubstr("\rimport trials  132"));
}

TEST_F(ProgressDisplayTest, PartsOfAPhaseAddUpToIt) {
  double sum = 0;
  const Progress progress([&](absl::string_view phase, double fraction) {
    EXPECT_EQ(phase, "folds");
    sum += fraction;
  });
  const Progress folds = progress.Part("folds", 0.1);
  for (int i = 0; i < 4; ++i) {
    const Progress fold = folds.Part("", 0.25);
    fold.Part("fit HMMs", 0.3).Add(1);
    fold.Part("train LSTMs", 0.7).Add(1);
  }
  EXPECT_NEAR(sum, 1, 1e-12);
}

}  // namespace
}  // namespace tactus::internal::client
