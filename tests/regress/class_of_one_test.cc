// With one contact of a class, fit and evaluate spoke of "a class" and gave
// advice that led to the next error. Each advice is followed here.
#include "core/base/errors.h"
#include "core/data/trial_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/small_trials.h"
#include "tests/support/trainctl_run.h"

namespace tactus::internal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::RunTrainctl;

// Eight trials each of HU and SU, and `extra` of class c in condition `slow`;
// `extra_label` replaces their label.
std::string Trials(const ScratchDir& folder, int extra,
                   const std::string& extra_label = "c", int others = 16) {
  const std::string path = folder / ("trials" + std::to_string(extra) + ".h5");
  auto writer = TrialFileWriter::Create(path, {.overwrite = true});
  EXPECT_TRUE(writer.ok()) << writer.status();
  for (int i = 0; i < others + extra; ++i) {
    Trial trial = testing::SmallTrial(i);
    if (i >= others) {
      trial.label = extra_label;
      trial.condition = "slow";
    }
    EXPECT_TRUE(writer->Append(trial).ok());
  }
  EXPECT_TRUE(writer->Close().ok());
  return path;
}

constexpr char kModels[] = " --preset=paper --networks=0 --states=2";

std::string Fit(const std::string& data, const ScratchDir& folder) {
  return "fit --data=" + data + " --out=" + (folder / "x.tactus");
}

std::string Evaluate(const std::string& data, const std::string& protocol) {
  return "evaluate --data=" + data + " --protocol=" + protocol;
}

TEST(ClassOfOneTest, IsNamedWithItsCountAndAdviceThatWorks) {
  const ScratchDir folder;
  const std::string one = Trials(folder, 1);
  for (const std::string& command :
       {Fit(one, folder) + kModels, Fit(one, folder) + " --preset=auto",
        Evaluate(one, "k-fold --folds=5") + kModels,
        Evaluate(one, "loco") + kModels,
        Evaluate(one, "leave-one-out") + kModels}) {
    const auto run = RunTrainctl(command);
    EXPECT_EQ(ReasonOf(run.status), "INVALID_TRAINING_DATA") << command;
    EXPECT_THAT(run.status.message(),
                AllOf(HasSubstr("class \"c\" has 1 contact;"),
                      HasSubstr("--skip-unusable")))
        << command;
    if (command.find("auto") != std::string::npos) continue;
    const auto skipped = RunTrainctl(command + " --skip-unusable --json");
    ASSERT_TRUE(skipped.status.ok()) << command << ": " << skipped.status;
  }
}

TEST(ClassOfOneTest, TheAdvisedNumberSuffices) {
  const ScratchDir folder;
  EXPECT_TRUE(
      RunTrainctl(Fit(Trials(folder, 2), folder) + kModels).status.ok());
  const std::string two = Trials(folder, 2);
  const auto run = RunTrainctl(Evaluate(two, "k-fold --folds=5") + kModels);
  EXPECT_THAT(run.status.message(),
              AllOf(HasSubstr("class \"c\" has 2 contacts;"),
                    HasSubstr("record 1 or more further ones")));
  const std::string three = Trials(folder, 3);
  for (const char* protocol : {"k-fold --folds=5", "leave-one-out"}) {
    const auto enough = RunTrainctl(Evaluate(three, protocol) + kModels);
    EXPECT_TRUE(enough.status.ok()) << enough.status;
  }
}

TEST(ClassOfOneTest, AClassOfOneConditionIsNamedWithIt) {
  const ScratchDir folder;
  const std::string three = Trials(folder, 3);
  const auto run = RunTrainctl(Evaluate(three, "loco") + kModels);
  EXPECT_THAT(run.status.message(),
              AllOf(HasSubstr("class \"c\" has 3 contacts"),
                    HasSubstr("condition \"slow\" leaves 0"),
                    HasSubstr("--protocol=k-fold")));
}

TEST(ClassOfOneTest, TrialsWithoutALabelAndOneClassAreNamed) {
  const ScratchDir folder;
  const std::string without = Trials(folder, 3, "");
  const auto run = RunTrainctl(Fit(without, folder) + kModels);
  EXPECT_THAT(run.status.message(),
              AllOf(HasSubstr("3 of 19 contacts have no label"),
                    HasSubstr("--skip-unusable")));
  EXPECT_TRUE(RunTrainctl(Fit(without, folder) + kModels + " --skip-unusable")
                  .status.ok());
  const std::string same = Trials(folder, 4, "c", 0);
  const auto one_class = RunTrainctl(Fit(same, folder) + kModels);
  EXPECT_THAT(one_class.status.message(),
              AllOf(HasSubstr("all 4 contacts are \"c\""),
                    HasSubstr("record another class"),
                    Not(HasSubstr("--skip-unusable"))));
}

// Leaving either class out would leave one.
TEST(ClassOfOneTest, AdviceThatWouldNotHelpIsNotGiven) {
  const ScratchDir folder;
  const std::string path = folder / "few.h5";
  auto writer = TrialFileWriter::Create(path, {.overwrite = true});
  for (const int i : {0, 2, 4, 1}) {
    EXPECT_TRUE(writer->Append(testing::SmallTrial(i)).ok());
  }
  EXPECT_TRUE(writer->Close().ok());
  const auto run = RunTrainctl(Fit(path, folder) + kModels);
  EXPECT_THAT(run.status.message(),
              AllOf(HasSubstr("class \"HU\" has 1 contact;"),
                    Not(HasSubstr("--skip-unusable"))));
}

// Every condition has one class: leaving one out to calibrate with left none of
// it, and the fit ended with "no inner fold leaves contacts of every class".
TEST(ClassOfOneTest, ConditionsThatAreClassesCanBeFitted) {
  const ScratchDir folder;
  const std::string path = folder / "sessions.h5";
  auto writer = TrialFileWriter::Create(path, {.overwrite = true});
  for (int i = 0; i < 12; ++i) {
    Trial trial = testing::SmallTrial(i);
    trial.condition = trial.label == "HU" ? "monday" : "tuesday";
    EXPECT_TRUE(writer->Append(trial).ok());
  }
  EXPECT_TRUE(writer->Close().ok());
  const auto run = RunTrainctl(Fit(path, folder) + kModels);
  EXPECT_TRUE(run.status.ok()) << run.status;
}

}  // namespace
}  // namespace tactus::internal
