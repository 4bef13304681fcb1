#include "client/tools/trainctl/fit_flags.h"

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::client {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(FitFlagsTest, WithoutCuesTakesThemFromAllInputs) {
  const auto all = FitFlags().Options("world");
  FitFlags flags;
  flags.without_cues = "log_drag,log_area";
  const auto fewer = flags.Options("world");
  ASSERT_TRUE(all.ok() && fewer.ok()) << fewer.status();
  EXPECT_EQ(fewer->hmm_cues.size(), all->hmm_cues.size() - 2);
  EXPECT_EQ(fewer->lstm.cues.size(), all->lstm.cues.size() - 2);
  EXPECT_EQ(fewer->lstm.stretched_cues.size(),
            all->lstm.stretched_cues.size() - 1);
  for (const auto& cues :
       {fewer->hmm_cues, fewer->lstm.cues, fewer->lstm.stretched_cues}) {
    EXPECT_THAT(cues, Not(Contains(Cue::kLogDrag)));
    EXPECT_THAT(cues, Not(Contains(Cue::kLogArea)));
  }
}

TEST(FitFlagsTest, WithoutCuesRefusesWhatHasNoEffect) {
  FitFlags flags;
  for (const char* cue : {"row_load_0", "log_dreg", "log_drag,log_drag"}) {
    flags.without_cues = cue;
    const absl::Status status = flags.Options("world").status();
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << cue;
    EXPECT_THAT(status.message(), HasSubstr("--without-cues"));
  }
  // Without any cue, models would take the features themselves.
  flags.hmm_cues = flags.without_cues = "log_drag";
  EXPECT_EQ(ReasonOf(flags.Options("world").status()), "INVALID_CONFIG");
}

}  // namespace
}  // namespace tactus::client
