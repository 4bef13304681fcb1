// Tokens files: what they say, and that each mistake is named with its line.
#include "core/access/access_table.h"

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// `printf %s secret | sha256sum`, and the same for "other".
constexpr char kSecret[] =
    "2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b";
constexpr char kOther[] =
    "d9298a10d1b0735837dc4bd85dac641b0f3cef27a47e5d53a54f2f3f5b2fcffa";

TEST(AccessTableTest, FindsTokensAndCertificates) {
  const auto table = AccessTable::Parse(absl::StrCat(
      "# robots\n\n  arm-7\trobot  ", kSecret, "\r\nboss admin ", kOther,
      "\n  # a comment\ncertificate lab-pc.example trainer\n"
      "certificate arm-7 admin"));
  ASSERT_TRUE(table.ok()) << table.status();
  const auto* robot = table->FindToken("secret");
  ASSERT_NE(robot, nullptr);
  EXPECT_EQ(robot->name, "arm-7");
  EXPECT_EQ(robot->role, Role::kRobot);
  const auto* admin = table->FindToken("other");
  ASSERT_NE(admin, nullptr);
  EXPECT_EQ(admin->role, Role::kAdmin);
  for (const char* wrong : {"", "secre", "secret ", "Secret", kSecret}) {
    EXPECT_EQ(table->FindToken(wrong), nullptr) << wrong;
  }
  const auto* trainer = table->FindCertificate("lab-pc.example");
  ASSERT_NE(trainer, nullptr);
  EXPECT_EQ(trainer->role, Role::kTrainer);
  EXPECT_EQ(table->FindCertificate("lab-pc"), nullptr);
  EXPECT_EQ(table->FindCertificate(""), nullptr);
}

TEST(AccessTableTest, EachMistakeIsNamedWithItsLine) {
  const std::string good = absl::StrCat("arm-7 robot ", kSecret, "\n");
  const std::string long_name(65, 'a');
  std::string many;
  for (size_t i = 0; i <= AccessTable::kMaxEntries; ++i) {
    absl::StrAppend(&many, "certificate c", i, " robot\n");
  }
  struct Case {
    std::string text;
    std::string want;
  };
  const std::vector<Case> cases = {
      {"", "number of entries is 0"},
      {"# only a comment\n\n", "number of entries is 0"},
      {many, "line 1001: the number of entries is 1001"},
      {std::string(AccessTable::kMaxFileBytes + 1, '#'), "the size is"},
      {good + "arm-8\n", "line 2: the number of words is 1"},
      {good + "arm-8 robot\n", "line 2: the number of words is 2"},
      {good + absl::StrCat("arm-8 robot ", kOther, " x\n"),
       "line 2: the number of words is 4"},
      {"certificate lab-pc\n", "certificate NAME ROLE"},
      {"certificate lab pc robot\n", "line 1: the number of words is 4"},
      {absl::StrCat("\n\narm-8 root ", kOther), "line 3: the role is \"root\""},
      {absl::StrCat("arm-8 Robot ", kOther), "line 1: the role is \"Robot\""},
      {"certificate lab-pc root\n", "line 1: the role is \"root\""},
      {absl::StrCat("certificate robot ", kOther), "line 1: the role is"},
      {absl::StrCat("arm/8 robot ", kOther), "line 1: the name is \"arm/8\""},
      {absl::StrCat("arm\x01 robot ", kOther), "line 1: the name is"},
      {absl::StrCat("\xc3\xa4rm robot ", kOther), "line 1: the name is"},
      {absl::StrCat(long_name, " robot ", kOther), "1 to 64 letters"},
      {absl::StrCat("certificate ", long_name, " robot"), "1 to 64 letters"},
      {"arm-8 robot secret\n", "line 1: the SHA-256 is a word of 6 bytes"},
      {absl::StrCat("arm-8 robot ", kOther, "0"), "a word of 65 bytes"},
      {absl::StrCat("arm-8 robot G", kOther + 1), "lower case"},
      {good + absl::StrCat("arm-7 admin ", kOther),
       "line 2: the name is \"arm-7\""},
      {good + absl::StrCat("arm-8 admin ", kSecret),
       "line 2: the SHA-256 is that of arm-7"},
      {"certificate a robot\ncertificate a admin\n",
       "line 2: the certificate is \"a\""},
  };
  for (const auto& [text, want] : cases) {
    const auto table = AccessTable::Parse(text);
    ASSERT_FALSE(table.ok()) << want;
    EXPECT_EQ(ReasonOf(table.status()), "INVALID_CONFIG");
    EXPECT_THAT(std::string(table.status().message()), HasSubstr(want));
  }
}

TEST(AccessTableTest, AMistakeDoesNotShowWhatMayBeAToken) {
  const auto table = AccessTable::Parse("arm-7 robot my-own-token\n");
  EXPECT_THAT(std::string(table.status().ToString()),
              Not(HasSubstr("my-own-token")));
}

TEST(TokenLineTest, IsALineOfTheFile) {
  const auto line = TokenLine("arm-7", Role::kTrainer, "secret");
  ASSERT_TRUE(line.ok()) << line.status();
  EXPECT_EQ(*line, absl::StrCat("arm-7 trainer ", kSecret, "\n"));
  for (const char* name : {"", "a b", "#a", "a\n", "certificate"}) {
    EXPECT_EQ(ReasonOf(TokenLine(name, Role::kRobot, "x").status()),
              "INVALID_CONFIG")
        << name;
  }
}

}  // namespace
}  // namespace tactus::internal
