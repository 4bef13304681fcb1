// `trainctl evalute` said "A subcommand is required", and a wrong flag was
// named without the right one.
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tools/trainctl/app.h"
#include "tools/trainctl/unknown_word.h"

namespace tactus::internal::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string Of(const std::vector<std::string>& words) {
  CLI::App app;
  AddCommands(app, [](const Command&) {});
  return UnknownWord(app, words);
}

TEST(UnknownCommandTest, IsNamedWithWhatWasMeant) {
  EXPECT_EQ(Of({"evalute", "--data=x.h5"}),
            "\"evalute\" is not a command of trainctl; did you mean trainctl "
            "evaluate?");
  EXPECT_THAT(Of({"modles", "list"}),
              HasSubstr("did you mean trainctl models"));
  EXPECT_THAT(Of({"jobs", "lsit"}),
              AllOf(HasSubstr("\"lsit\" is not a command of trainctl jobs"),
                    HasSubstr("did you mean trainctl jobs list?")));
  // A verb of a group, without the group.
  EXPECT_THAT(Of({"promote", "arm@3"}),
              HasSubstr("did you mean trainctl models promote?"));
  EXPECT_THAT(Of({"xyzzy"}), HasSubstr("it must be one of simulate, "));
}

TEST(UnknownCommandTest, FlagsAreNamed) {
  EXPECT_EQ(Of({"fit", "--data=x", "--pretest=tuned"}),
            "\"--pretest\" is not a flag of trainctl fit; did you mean "
            "--preset?");
  EXPECT_THAT(Of({"fit", "--frobnicate"}), HasSubstr("trainctl fit --help"));
}

TEST(UnknownCommandTest, KnownWordsAreNot) {
  EXPECT_EQ(Of({"evaluate", "--data=x.h5", "--model=evalute"}), "");
  EXPECT_EQ(Of({"jobs", "watch", "7"}), "");
  EXPECT_EQ(Of({}), "");
}

TEST(UnknownCommandTest, TheProgramExitsAsAfterWrongUsage) {
  std::string words[] = {"trainctl", "evalute"};
  char* argv[] = {words[0].data(), words[1].data(), nullptr};
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(RunTrainctl(2, argv), 2);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              HasSubstr("did you mean trainctl evaluate?"));
}

}  // namespace
}  // namespace tactus::internal::client
