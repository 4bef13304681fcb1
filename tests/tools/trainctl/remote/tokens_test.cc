// trainctl tokens, run as from the command line.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "core/access/access_table.h"
#include "core/base/errors.h"
#include "core/base/sha256.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tools/common/json.h"
#include "tools/common/token_file.h"
#include "tools/trainctl/verbs.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;
using ::testing::internal::CaptureStderr;
using ::testing::internal::CaptureStdout;
using ::testing::internal::GetCapturedStderr;
using ::testing::internal::GetCapturedStdout;

class TokensTest : public ::testing::Test {
 protected:
  TokensTest()
      : path_(absl::StrCat(::testing::TempDir(), "/tokens-test-", getpid())) {}
  ~TokensTest() override { std::filesystem::remove(path_); }

  // What the command prints on standard output goes into `printed`.
  absl::Status Run(const std::string& arguments,
                   std::string* printed = nullptr) {
    CLI::App app;
    Command command;
    AddTokens(app, [&](Command chosen) { command = std::move(chosen); });
    app.parse("tokens " + arguments);
    CaptureStdout();
    CaptureStderr();
    const absl::Status status = command();
    const std::string out = GetCapturedStdout();
    stderr_ = GetCapturedStderr();
    if (printed != nullptr) *printed = out;
    return status;
  }
  std::string File() const { return *ReadFileBytes(path_, 1 << 20); }
  void Write(const std::string& text) const { std::ofstream(path_) << text; }

  const std::string path_;
  std::string stderr_;
};

TEST_F(TokensTest, CreateAddsTheHashOfWhatItPrints) {
  std::string first;
  std::string second;
  ASSERT_TRUE(
      Run("create --name=arm-7 --role=robot --file=" + path_, &first).ok());
  ASSERT_TRUE(
      Run("create --name=lab --role=trainer --file=" + path_, &second).ok());
  EXPECT_NE(first, second);
  EXPECT_EQ(first.size(), 65u);
  for (std::string* token : {&first, &second}) {
    *token = std::string(absl::StripAsciiWhitespace(*token));
  }
  EXPECT_EQ(File(), absl::StrCat("arm-7 robot ", Sha256Hex(first),
                                 "\nlab trainer ", Sha256Hex(second), "\n"));
  const auto table = AccessTable::Parse(File());
  ASSERT_TRUE(table.ok()) << table.status();
  ASSERT_NE(table->FindToken(second), nullptr);
  EXPECT_EQ(table->FindToken(second)->role, Role::kTrainer);
}

TEST_F(TokensTest, CreateWithoutAFilePrintsTheLine) {
  std::string token;
  ASSERT_TRUE(Run("create --name=arm-7 --role=robot", &token).ok());
  token = std::string(absl::StripAsciiWhitespace(token));
  EXPECT_THAT(stderr_, HasSubstr(*TokenLine("arm-7", Role::kRobot, token)));
}

TEST_F(TokensTest, AMistakeLeavesTheFileAsItWas) {
  // The last line has no end.
  const std::string before = "# mine\ncertificate pc admin";
  Write(before);
  const std::string file = " --file=" + path_;
  for (const char* wrong :
       {"create --name=arm/7 --role=robot", "create --name=arm --role=root",
        "create --name=certificate --role=robot"}) {
    EXPECT_EQ(ReasonOf(Run(wrong + file)), "INVALID_CONFIG") << wrong;
    EXPECT_EQ(File(), before) << wrong;
  }
  ASSERT_TRUE(Run("create --name=arm --role=robot" + file).ok());
  EXPECT_THAT(File(), HasSubstr(before + "\narm robot "));
  const std::string good = File();
  EXPECT_THAT(
      std::string(Run("create --name=arm --role=admin" + file).message()),
      HasSubstr("line 4: the name is \"arm\""));
  EXPECT_EQ(File(), good);
  EXPECT_EQ(ReasonOf(Run("create --name=a --role=robot --file=/no/such/file")),
            "IO");
}

TEST_F(TokensTest, ListShowsNamesAndRoles) {
  Write(*TokenLine("arm", Role::kRobot, "x") + "certificate pc admin\n");
  std::string text;
  ASSERT_TRUE(Run("list --file=" + path_, &text).ok());
  EXPECT_THAT(text, ::testing::MatchesRegex("arm +robot +token\n"
                                            "pc +admin +certificate\n"));
  ASSERT_TRUE(Run("list --json --file=" + path_, &text).ok());
  EXPECT_EQ(Json::parse(text),
            Json::parse(R"([{"name": "arm", "role": "robot", "kind": "token"},
                            {"name": "pc", "role": "admin",
                             "kind": "certificate"}])"));
  Write("arm\n");
  EXPECT_THAT(std::string(Run("list --file=" + path_).message()),
              HasSubstr(path_ + ": line 1: "));
}

TEST_F(TokensTest, ATokenFileHoldsOneWordAndStaysOffPlainNetworks) {
  Write(" secret\n");
  for (const char* local : {"unix:/run/a", "127.0.0.1:1", "localhost:1"}) {
    EXPECT_EQ(ReadToken(path_, local, false).value_or(""), "secret") << local;
  }
  EXPECT_EQ(ReadToken(path_, "arm.lab:1", true).value_or(""), "secret");
  EXPECT_EQ(ReasonOf(ReadToken(path_, "arm.lab:1", false).status()),
            "INVALID_CONFIG");
  for (const char* wrong : {"", "\n", "two words", "a\tb", "\xc3\xa4"}) {
    Write(wrong);
    EXPECT_EQ(ReasonOf(ReadToken(path_, "unix:a", false).status()), "IO")
        << wrong;
  }
}

TEST_F(TokensTest, RemoveTakesOneNameAndNothingElse) {
  const std::string arm = *TokenLine("arm", Role::kRobot, "a");
  const std::string lab = *TokenLine("lab", Role::kTrainer, "b");
  const std::string text =
      absl::StrCat("# Arms\n", arm, "\n  certificate arm-2 admin\r\n", lab,
                   "# arm is a word of this line");
  Write(text);
  ASSERT_TRUE(Run("remove --name=lab --file=" + path_).ok());
  EXPECT_EQ(File(), absl::StrReplaceAll(text, {{lab, ""}}));
  EXPECT_THAT(stderr_, HasSubstr("SIGHUP"));
  // A certificate by its name, and not the word "certificate".
  EXPECT_FALSE(Run("remove --name=certificate --file=" + path_).ok());
  EXPECT_FALSE(Run("remove --name=# --file=" + path_).ok());
  ASSERT_TRUE(Run("remove --name=arm-2 --file=" + path_).ok());
  EXPECT_EQ(File(),
            absl::StrCat("# Arms\n", arm, "\n# arm is a word of this line"));
}

TEST_F(TokensTest, RemoveNamesWhatThereIs) {
  const std::string text = absl::StrCat(*TokenLine("arm", Role::kRobot, "a"),
                                        "certificate lab-pc trainer\n");
  Write(text);
  const absl::Status status = Run("remove --name=amr --file=" + path_);
  EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
  EXPECT_THAT(status.message(), HasSubstr("\"amr\""));
  EXPECT_THAT(status.message(), HasSubstr("arm, lab-pc"));
  EXPECT_EQ(File(), text);
  EXPECT_EQ(ReasonOf(Run("remove --name=arm --file=" + path_ + ".none")), "IO");
  EXPECT_FALSE(std::filesystem::exists(path_ + ".none"));
}

// A server would refuse the file without it, and go on to accept the token.
TEST_F(TokensTest, RemoveKeepsTheLastEntry) {
  const std::string text = *TokenLine("arm", Role::kRobot, "a");
  Write(text);
  const absl::Status status = Run("remove --name=arm --file=" + path_);
  EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
  EXPECT_THAT(status.message(), HasSubstr("last entry"));
  EXPECT_EQ(File(), text);
}

}  // namespace
}  // namespace tactus::internal::client
