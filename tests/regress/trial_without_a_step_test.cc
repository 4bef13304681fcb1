// A fit died late with "sequence 7737 has no frames" if one of thousands of
// contacts, or of their copies, ended before the first step of the models.
#include <fstream>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/data/trial_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/trainctl_run.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;
using testing::RunTrainctl;

// Twelve trials of two classes; number 7 has `frames` frames, the others 40.
// Returns the path.
std::string TrialsWithAShortOne(const ScratchDir& folder, int frames) {
  const std::string path = folder / "short_trial.h5";
  auto writer = TrialFileWriter::Create(path, {.overwrite = true});
  EXPECT_TRUE(writer.ok()) << writer.status();
  Random random(1);
  for (int i = 0; i < 12; ++i) {
    Trial trial;
    trial.label = i % 2 == 0 ? "hard" : "soft";
    trial.condition = i < 6 ? "slow" : "fast";
    for (int t = 1; t <= (i == 7 ? frames : 40); ++t) {
      trial.time.push_back(0.01 * t);
      trial.signals.push_back({(i % 2 + random.Uniform()) * t,
                               1e-4 * (1 + random.Uniform()),
                               1e-4 * (t + random.Uniform())});
    }
    EXPECT_TRUE(writer->Append(trial).ok());
  }
  EXPECT_TRUE(writer->Close().ok());
  return path;
}

std::string FitCommand(const ScratchDir& folder, int frames) {
  return "fit --networks=1 --epochs=1 --hmms-per-class=1 --states=2 --json "
         "--data=" +
         TrialsWithAShortOne(folder, frames) +
         " --out=" + (folder / "short_trial.tactus");
}

TEST(TrialWithoutAStepTest, IsNamedBeforeTheFit) {
  const ScratchDir folder;
  const auto run = RunTrainctl(FitCommand(folder, 4));
  EXPECT_EQ(ReasonOf(run.status), "INVALID_TRAINING_DATA");
  EXPECT_THAT(run.status.message(), HasSubstr("1 of 12"));
  EXPECT_THAT(run.status.message(), HasSubstr("000007"));
}

TEST(TrialWithoutAStepTest, IsLeftOutIfTheUserWishes) {
  const ScratchDir folder;
  const auto run = RunTrainctl(FitCommand(folder, 4) + " --skip-unusable");
  ASSERT_TRUE(run.status.ok()) << run.status;
  const auto report = client::Json::parse(run.out);
  EXPECT_EQ(report["unusable"], client::Json({"000007"}));
  EXPECT_EQ(report["trials"], 12);
}

// Copies at another pace last down to a third of the time.
TEST(TrialWithoutAStepTest, ACopyWithoutAStepIsLeftOut) {
  const ScratchDir folder;
  const auto run = RunTrainctl(FitCommand(folder, 6));
  ASSERT_TRUE(run.status.ok()) << run.status;
  EXPECT_TRUE(client::Json::parse(run.out)["unusable"].empty());
}

}  // namespace
}  // namespace tactus::internal
