#include "tools/trainctl/completion.h"

#include <array>
#include <cstdio>
#include <fstream>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::client {
namespace {

class CompletionTest : public ::testing::Test {
 protected:
  CompletionTest() {
    CLI::App* models = app_.add_subcommand("models", "");
    CLI::App* promote = models->add_subcommand("promote", "");
    promote->add_option("--alias", alias_, "");
    promote->add_flag("--force");
    models->add_subcommand("list", "");
    app_.add_subcommand("train", "")->add_option("--model", alias_, "");
  }

  // What bash offers after the words, of which the last one is incomplete.
  std::string Complete(const std::string& words) {
    const ScratchDir folder;
    const std::string path = folder / "completion.bash";
    std::ofstream(path) << CompletionScript(app_, Shell::kBash)
                        << "COMP_WORDS=(trainctl " << words << ")\n"
                        << "COMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n"
                        << "_trainctl\n"
                        << "echo \"${COMPREPLY[*]}\"\n";
    FILE* shell = popen(("bash " + path + " 2>&1").c_str(), "r");
    std::array<char, 1000> text = {};
    const size_t size = fread(text.data(), 1, text.size(), shell);
    EXPECT_EQ(pclose(shell), 0);
    return std::string(text.data(), size);
  }

  CLI::App app_;
  std::string alias_;
};

TEST_F(CompletionTest, BashOffersWhatMayFollow) {
  EXPECT_EQ(Complete("''"), "models train --help\n");
  EXPECT_EQ(Complete("mod"), "models\n");
  EXPECT_EQ(Complete("models ''"), "promote list --help\n");
  EXPECT_EQ(Complete("models promote --"), "--help --alias --force\n");
  EXPECT_EQ(Complete("models promote arm@2 --f"), "--force\n");
  // The value of an option is no command.
  EXPECT_EQ(Complete("train --model list --m"), "--model\n");
  EXPECT_EQ(Complete("nothing --x"), "\n");
}

TEST_F(CompletionTest, ZshHasTheSameTable) {
  const std::string script = CompletionScript(app_, Shell::kZsh);
  EXPECT_THAT(script, ::testing::StartsWith("#compdef trainctl\n"));
  EXPECT_THAT(script,
              ::testing::HasSubstr(
                  "'models promote') choices='--help --alias --force'"));
}

}  // namespace
}  // namespace tactus::internal::client
