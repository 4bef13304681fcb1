// A file that cannot be written must end an evaluation before its hours of
// work, not after them.
#include <filesystem>
#include <fstream>

#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/trainctl_run.h"

namespace tactus::internal {
namespace {

using client::Json;
using ::testing::HasSubstr;
using testing::RunTrainctl;

// The data is missing, too: the first error is the one of the answers.
TEST(AnswersThatCannotBeWrittenTest, AreFoundBeforeTheWork) {
  const ScratchDir scratch;
  const std::string folder = scratch.path();
  for (const std::string flags : {"--protocol=loco", "--model=none.tactus"}) {
    const std::string command = "evaluate --data=none.h5 " + flags;
    for (const std::string& path :
         {folder + "/no/answers.csv", folder, std::string("/proc/a.csv")}) {
      const auto run = RunTrainctl(command + " --answers=" + path);
      EXPECT_EQ(ReasonOf(run.status), "IO") << path;
      EXPECT_THAT(run.status.message(), HasSubstr(path));
    }
    const auto run =
        RunTrainctl(command + " --answers=" + folder + "/answers.csv");
    EXPECT_THAT(run.status.message(), HasSubstr("none."));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST(AnswersThatCannotBeWrittenTest, ProtocolsAndBundlesWriteThem) {
  const ScratchDir folder;
  const std::string data = folder / "answers.h5";
  const std::string bundle = folder / "answers.tactus";
  const std::string answers = folder / "answers.csv";
  const std::string fit = " --preset=paper --networks=0 --states=3";
  const auto run = [](const std::string& arguments) {
    const auto done = RunTrainctl(arguments);
    EXPECT_TRUE(done.status.ok()) << done.status;
    return done.out;
  };
  run("simulate --protocol=grid --sample=80 --stiffness=543,2050 "
      "--velocity=0.02 --goal=0.019 --out=" +
      data);
  run("fit --data=" + data + " --out=" + bundle + fit);
  for (const std::string& how :
       {" --protocol=k-fold --folds=2" + fit, " --model=" + bundle}) {
    const Json json = Json::parse(
        run("evaluate --json --data=" + data + how + " --answers=" + answers));
    std::ifstream file(answers);
    std::string line;
    ASSERT_TRUE(std::getline(file, line));
    EXPECT_THAT(line,
                HasSubstr("trial,label,label_so_far,answer,probability_"));
    int trials = 0;
    int right = 0;
    while (std::getline(file, line)) {
      const std::vector<std::string> cells = absl::StrSplit(line, ',');
      ++trials;
      right += cells[1] == cells[3];
    }
    EXPECT_EQ(trials, json["felt"].get<int>()) << how;
    EXPECT_EQ(right, json["right"].get<int>()) << how;
  }
}

}  // namespace
}  // namespace tactus::internal
