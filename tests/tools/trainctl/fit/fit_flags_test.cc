#include "tools/trainctl/fit/fit_flags.h"

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::client {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(FitFlagsTest, WithCuesGivesThemToTheLstms) {
  const auto preset = FitFlags().Options("world");
  FitFlags flags;
  flags.spec.with_cues = "force_pitch_short,log_row_spread";
  const auto more = flags.Options("world");
  ASSERT_TRUE(preset.ok() && more.ok()) << more.status();
  EXPECT_EQ(more->hmm_cues, preset->hmm_cues);
  std::vector<Cue> expected = preset->lstm.cues;
  expected.insert(expected.end(),
                  {NamedCue("force_pitch_short"), NamedCue("log_row_spread")});
  EXPECT_EQ(more->lstm.cues, expected);
}

TEST(FitFlagsTest, WithCuesRefusesWhatHasNoEffect) {
  FitFlags flags;
  const auto refused = [&](const char* cues, const char* preset) {
    flags.spec.with_cues = cues;
    const absl::Status status = flags.Options(preset).status();
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << cues;
    EXPECT_THAT(status.message(), HasSubstr("with_cues"));
  };
  refused("log_drag", "world");
  refused("log_dreg", "world");
  refused("force_pitch_long,force_pitch_long", "world");
  refused("force_pitch_long", "profile");
}

TEST(FitFlagsTest, WithoutCuesTakesThemFromAllInputs) {
  const auto all = FitFlags().Options("world");
  FitFlags flags;
  flags.spec.without_cues = "log_drag,log_area";
  const auto fewer = flags.Options("world");
  ASSERT_TRUE(all.ok() && fewer.ok()) << fewer.status();
  EXPECT_EQ(fewer->hmm_cues.size(), all->hmm_cues.size() - 2);
  EXPECT_EQ(fewer->lstm.cues.size(), all->lstm.cues.size() - 2);
  EXPECT_EQ(fewer->lstm.stretched_cues.size(),
            all->lstm.stretched_cues.size() - 1);
  for (const auto& cues :
       {fewer->hmm_cues, fewer->lstm.cues, fewer->lstm.stretched_cues}) {
    EXPECT_THAT(cues, Not(Contains(NamedCue("log_drag"))));
    EXPECT_THAT(cues, Not(Contains(NamedCue("log_area"))));
  }
}

TEST(FitFlagsTest, WithoutCuesRefusesWhatHasNoEffect) {
  FitFlags flags;
  for (const char* cue : {"row_load_0", "log_dreg", "log_drag,log_drag"}) {
    flags.spec.without_cues = cue;
    const absl::Status status = flags.Options("world").status();
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << cue;
    EXPECT_THAT(status.message(), HasSubstr("without_cues"));
  }
  // Without any cue, models would take the features themselves.
  flags.hmm_cues = flags.spec.without_cues = "log_drag";
  EXPECT_EQ(ReasonOf(flags.Options("world").status()), "INVALID_CONFIG");
}

TEST(FitFlagsTest, QuestionsAreReadFromAFile) {
  const ScratchDir folder;
  FitFlags flags;
  flags.spec.questions = folder / "table.csv";
  EXPECT_EQ(ReasonOf(flags.Options("world").status()), "IO");
  WriteBytes(flags.spec.questions, "class,loose\nHU,no\nHM,yes\n");
  const auto options = flags.Options("world");
  ASSERT_TRUE(options.ok()) << options.status();
  EXPECT_EQ(options->questions.class_names,
            (std::vector<std::string>{"HU", "HM"}));
  WriteBytes(flags.spec.questions, "class,loose\nHU,no\nHM\n");
  const absl::Status status = flags.Options("world").status();
  EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
  EXPECT_THAT(std::string(status.message()), HasSubstr("table.csv: number of"));
}

}  // namespace
}  // namespace tactus::internal::client
