// `trainctl evaluate --model` ignored --preset, --features and the other flags
// of a fit, so that its figures seemed to be those of another model.
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/trainctl_run.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;
using testing::RunTrainctl;

TEST(FitFlagsWithoutEffectTest, AreRefusedBesideABundle) {
  for (const std::string flag :
       {"--preset=paper", "--choice-work=0", "--features=f", "--seed=2",
        "--states=3", "--hmms-per-class=2", "--networks=0", "--epochs=1",
        "--no-estimates", "--stretches=1", "--skip-unusable",
        "--hmm-cues=force", "--lstm-cues=force",
        "--with-cues=force_pitch_short", "--without-cues=log_drag"}) {
    const auto run =
        RunTrainctl("evaluate --data=none.h5 --model=none.tactus " + flag);
    EXPECT_EQ(ReasonOf(run.status), "INVALID_CONFIG") << flag;
    EXPECT_THAT(run.status.message(),
                HasSubstr(flag.substr(0, flag.find('='))));
  }
}

TEST(FitFlagsWithoutEffectTest, FlagsOfOtherProtocolsAreRefused) {
  for (const std::string flags :
       {"--model=none.tactus --folds=3", "--protocol=loco --folds=3",
        "--protocol=leave-one-category-out --algorithm=lstm",
        "--protocol=leave-one-category-out --figures=none"}) {
    const auto run = RunTrainctl("evaluate --data=none.h5 " + flags);
    EXPECT_EQ(ReasonOf(run.status), "INVALID_CONFIG") << flags;
  }
}

}  // namespace
}  // namespace tactus::internal
