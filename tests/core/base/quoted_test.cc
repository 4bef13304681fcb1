#include "core/base/quoted.h"

#include <string>

#include "core/base/limits.h"
#include "gtest/gtest.h"

namespace tactus {
namespace {

TEST(QuotedTest, NothingBreaksTheLineOrTheQuotes) {
  EXPECT_EQ(Quoted("left-arm"), "\"left-arm\"");
  EXPECT_EQ(Quoted("a\nb"), "\"a\\nb\"");
  EXPECT_EQ(Quoted("a\" ok"), "\"a\\\" ok\"");
  EXPECT_EQ(Quoted("\x1b[2J\xff"), "\"\\x1b[2J\\xff\"");
}

TEST(QuotedTest, LongTextIsCut) {
  const std::string most(limits::kMaxNameBytes, 'x');
  EXPECT_EQ(Quoted(most), "\"" + most + "\"");
  EXPECT_EQ(Quoted(most + "y"), "\"" + most + "\"...");
}

TEST(QuotedTest, ControlCharactersAreNotPrintable) {
  EXPECT_TRUE(IsPrintable("arm \xc3\xa9 \xe6\x89\x8b \xc2\xa0"));
  for (const char* text : {"a\n", "\x1b", "\x7f", "\xc2\x9b", "tab\t"}) {
    EXPECT_FALSE(IsPrintable(text));
  }
}

}  // namespace
}  // namespace tactus
