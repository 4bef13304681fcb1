#include "core/base/text.h"

#include <string>

#include "core/base/limits.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

using std::string_literals::operator""s;

const std::string kGood[] = {
    "",
    "HU",
    "gr\xC3\xBCn",
    "\xE2\x82\xAC",      // U+20AC
    "\xEF\xBF\xBF",      // U+FFFF
    "\xF0\x9F\x96\x90",  // U+1F590
    "\xF4\x8F\xBF\xBF",  // U+10FFFF
    "\xED\x9F\xBF",      // U+D7FF, below the surrogates
    "\xEE\x80\x80",      // U+E000, above them
    "\xC2\xA0",          // U+00A0, the first that is no control character
};

const std::string kBad[] = {
    "H\xFF",
    "\x80",              // continuation without a start
    "\xC3",              // cut short
    "\xE2\x82",          // cut short
    "\xF0\x9F\x96",      // cut short
    "\xC0\xAF",          // overlong '/'
    "\xC1\xBF",          // overlong
    "\xE0\x9F\xBF",      // overlong
    "\xF0\x8F\xBF\xBF",  // overlong
    "\xED\xA0\x80",      // surrogate U+D800
    "\xF4\x90\x80\x80",  // U+110000
    "\xF5\x80\x80\x80",
    "\xC3(",  // no continuation
};

TEST(TextTest, RecognisesUtf8) {
  for (const std::string& text : kGood) {
    EXPECT_TRUE(IsUtf8(text)) << text;
    EXPECT_EQ(TextFault(text, 10), "");
    EXPECT_EQ(Printable(text), text);
  }
  for (const std::string& text : kBad) {
    EXPECT_FALSE(IsUtf8("ab" + text + "cd")) << text;
    EXPECT_NE(TextFault(text, 10), "") << text;
    EXPECT_TRUE(IsUtf8(Printable(text))) << text;
  }
}

// Every character is read back from its bytes, and no prefix of them passes.
TEST(TextTest, EveryCharacterIsUtf8) {
  for (uint32_t code = 0; code <= 0x10FFFF; ++code) {
    if (code >= 0xD800 && code <= 0xDFFF) continue;
    std::string bytes;
    if (code < 0x80) {
      bytes = {static_cast<char>(code)};
    } else if (code < 0x800) {
      bytes = {static_cast<char>(0xC0 | code >> 6),
               static_cast<char>(0x80 | (code & 63))};
    } else if (code < 0x10000) {
      bytes = {static_cast<char>(0xE0 | code >> 12),
               static_cast<char>(0x80 | (code >> 6 & 63)),
               static_cast<char>(0x80 | (code & 63))};
    } else {
      bytes = {static_cast<char>(0xF0 | code >> 18),
               static_cast<char>(0x80 | (code >> 12 & 63)),
               static_cast<char>(0x80 | (code >> 6 & 63)),
               static_cast<char>(0x80 | (code & 63))};
    }
    ASSERT_TRUE(IsUtf8(bytes)) << code;
    if (bytes.size() > 1) {
      ASSERT_FALSE(IsUtf8(bytes.substr(0, bytes.size() - 1))) << code;
    }
  }
}

TEST(TextTest, FaultsNameThePlace) {
  EXPECT_EQ(TextFault("abc", 2), "has 3 bytes; it must have at most 2");
  EXPECT_EQ(TextFault("ab\xFF", 3), "is not UTF-8 at byte 2");
  for (const std::string& text :
       {"a\n"s, "a\0b"s, "a\x7F"s, "a\t"s, "a\xC2\x85"s}) {
    EXPECT_EQ(TextFault(text, 9), "holds a control character at byte 1");
  }
}

TEST(TextTest, PrintableIsOneLine) {
  EXPECT_EQ(Printable("a\nb\xFF\xC2\x85"s + "c"), "a?b??c");
  EXPECT_EQ(Printable("gr\xC3\xBCn\xC3"), "gr\xC3\xBCn?");
}

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

}  // namespace
}  // namespace tactus::internal
