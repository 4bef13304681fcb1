// The command line of trainctl: exit codes of wrong flags, help, examples.
#include <map>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/data/trial_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/training/sample_trials.h"
#include "tests/tools/trainctl/remote/trainctl_program.h"

namespace tactus::internal::client {
namespace {

TEST(TrainctlUsageTest, WrongUsageHasItsExitCode) {
  EXPECT_EQ(testing::Trainctl({}).exit, 2);
  EXPECT_EQ(testing::Trainctl({"models"}).exit, 2);
  EXPECT_EQ(testing::Trainctl({"train", "--model=a"}).exit, 2);
  EXPECT_EQ(testing::Trainctl({"datasets", "list", "--nonsense"}).exit, 2);
  EXPECT_EQ(testing::Trainctl({"completion", "fish"}).exit, 2);
  EXPECT_EQ(testing::Trainctl({"simulate", "--sensor=taxels"}).exit, 2);
  EXPECT_EQ(testing::Trainctl({"--version"}).exit, 0);
}

TEST(TrainctlUsageTest, WrongValuesOfFlagsAreWrongUsage) {
  const std::string file = ::testing::TempDir() + "/trainctl-usage.h5";
  auto writer = TrialFileWriter::Create(file, {.overwrite = true});
  ASSERT_TRUE(writer.ok()) << writer.status();
  for (const Trial& trial : testing::SampleTrials(5)) {
    ASSERT_TRUE(writer->Append(trial).ok());
  }
  ASSERT_TRUE(writer->Close().ok());
  const std::string out = "--out=" + file + ".made";
  for (const std::vector<std::string>& wrong :
       std::vector<std::vector<std::string>>{
           {"simulate", "--protocol=odd", out},
           {"simulate", "--protocol=grid", "--skin=odd", out},
           {"simulate", "--protocol=grid", "--noise=odd", out},
           {"simulate", "--protocol=grid", "--skin=good", "--noise=absolute"},
           {"simulate", "--protocol=random", "--noise=absolute", out},
           {"fit", "--data=" + file, "--preset=odd", out},
           {"fit", "--data=" + file, "--preset=tuned", "--features=z", out},
           {"fit", "--data=" + file, "--preset=tuned", "--epochs=-1", out},
           {"evaluate", "--data=" + file},
           {"evaluate", "--data=" + file, "--protocol=odd"},
           {"evaluate", "--data=" + file, "--protocol=loco", "--folds=3"},
           {"evaluate", "--data=" + file, "--protocol=loco", "--algorithm=odd"},
           {"trials", "export", file, "--format=odd", out},
           {"skin", "estimate", file, "--idle-taxels=3"},
           {"tokens", "create", "--name=a", "--role=odd"}}) {
    const testing::Outcome outcome = testing::Trainctl(wrong);
    EXPECT_EQ(outcome.exit, 2) << outcome.err;
    EXPECT_THAT(outcome.err, ::testing::HasSubstr("must be"));
  }
  // A file that is not there is no mistake of the command line.
  EXPECT_EQ(testing::Trainctl({"inspect", file + ".absent"}).exit, 1);
}

// Only ideal signals have a reading of the noise, only taxel frames a skin.
TEST(TrainctlUsageTest, SimulateSaysItsSkinOrItsNoise) {
  const auto simulate = [](std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"simulate", "--json"});
    const testing::Outcome outcome = testing::Trainctl(flags);
    EXPECT_EQ(outcome.exit, 0) << outcome.err;
    return outcome.json();
  };
  const Json signals = simulate({"--protocol=grid", "--sample=2"});
  EXPECT_EQ(signals.at("noise"), "relative");
  EXPECT_FALSE(signals.contains("skin"));
  const Json taxels =
      simulate({"--protocol=grid", "--sample=2", "--skin=paper"});
  EXPECT_EQ(taxels.at("skin"), "paper");
  EXPECT_FALSE(taxels.contains("noise"));
  const Json world = simulate({"--protocol=random", "--contacts=2"});
  EXPECT_EQ(world.at("skin"), "good");
  EXPECT_EQ(world.at("trials"), 2);
}

// All commands, from the table of the completion: "datasets upload", and its
// words.
std::vector<std::pair<std::string, std::vector<std::string>>> AllCommands() {
  std::vector<std::pair<std::string, std::vector<std::string>>> commands;
  const std::string script = testing::Trainctl({"completion", "bash"}).out;
  for (const absl::string_view line : absl::StrSplit(script, '\n')) {
    const std::vector<std::string> parts = absl::StrSplit(line, '\'');
    if (parts.size() != 5 || parts[2] != ") choices=") continue;
    commands.emplace_back(parts[1], absl::StrSplit(parts[3], ' '));
  }
  return commands;
}

// The help of every command and group ends with an example, and shows every
// word that the completion offers.
TEST(TrainctlUsageTest, HelpShowsAnExample) {
  const auto commands = AllCommands();
  EXPECT_GT(commands.size(), 40u);
  for (const auto& [path, words] : commands) {
    std::vector<std::string> arguments = {"--help"};
    if (!path.empty()) {
      arguments = absl::StrSplit(path, ' ');
      arguments.push_back("--help");
    }
    const testing::Outcome outcome = testing::Trainctl(arguments);
    EXPECT_EQ(outcome.exit, 0) << path;
    const size_t example = outcome.out.find("\nExample");
    ASSERT_NE(example, outcome.out.npos) << path;
    EXPECT_THAT(outcome.out.substr(example),
                ::testing::HasSubstr("\n  trainctl " + path));
    for (const std::string& word : words) {
      EXPECT_THAT(outcome.out, ::testing::HasSubstr(word)) << path;
    }
  }
}

// The words of the examples in the help are commands and flags that exist.
TEST(TrainctlUsageTest, ExamplesOfTheHelpUseKnownFlags) {
  const auto commands = AllCommands();
  const std::map<std::string, std::vector<std::string>> words_of(
      commands.begin(), commands.end());
  for (const auto& [path, words] : commands) {
    if (path.empty()) continue;
    std::vector<std::string> arguments = absl::StrSplit(path, ' ');
    arguments.push_back("--help");
    for (const absl::string_view line :
         absl::StrSplit(testing::Trainctl(arguments).out, '\n')) {
      if (!absl::StartsWith(line, "  trainctl ")) continue;
      std::string command;
      for (const absl::string_view word :
           absl::StrSplit(line.substr(11), ' ')) {
        const std::string longer =
            absl::StrCat(command, command.empty() ? "" : " ", word);
        if (words_of.contains(longer)) command = longer;
        if (!absl::StartsWith(word, "--")) continue;
        const std::string flag(word.substr(0, word.find('=')));
        EXPECT_THAT(words_of.at(command), ::testing::Contains(flag)) << line;
      }
    }
  }
}

}  // namespace
}  // namespace tactus::internal::client
