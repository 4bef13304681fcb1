#include "client/kinematics/urdf_text.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;

std::string Repeated(absl::string_view text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) absl::StrAppend(&all, text);
  return all;
}

std::string TextError(const std::string& urdf) {
  const absl::Status status = CheckUrdfText(urdf);
  if (status.ok()) return "";
  EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
  return std::string(status.message());
}

TEST(UrdfTextTest, NestingIsBounded) {
  const int most = limits::kMaxUrdfDepth;
  const std::string deep = Repeated("<a>", most) + Repeated("</a>", most);
  EXPECT_EQ(TextError(deep + deep), "");
  EXPECT_THAT(TextError("<a>" + deep), HasSubstr("nesting"));
  EXPECT_THAT(TextError(Repeated("<a>", 1'000'000)), HasSubstr("nesting"));
  // Not elements, or at once at their end.
  EXPECT_EQ(TextError(Repeated("<a/>", 1000)), "");
  EXPECT_EQ(TextError(Repeated("<a x='>' y=\"/>\"/>", 1000)), "");
  EXPECT_EQ(TextError(Repeated("<!-- <a> -->", 1000)), "");
  EXPECT_EQ(TextError(Repeated("<?xml a?><!DOCTYPE b>", 1000)), "");
  EXPECT_EQ(TextError(Repeated("<![CDATA[<a><a>]]>", 1000)), "");
}

TEST(UrdfTextTest, EndsThatAreNoneDoNotHideNesting) {
  for (const char* text : {"<a><!-- </a> -->", "<a><![CDATA[</a>]]>",
                           "<a x='</a>'>", "<a x='/>'>", "<a><?</a?>"}) {
    EXPECT_THAT(TextError(Repeated(text, 100)), HasSubstr("nesting")) << text;
  }
}

TEST(UrdfTextTest, JointsAreBounded) {
  const int most = limits::kMaxUrdfJoints;
  EXPECT_EQ(TextError(Repeated("<joint name='a'/>", most)), "");
  EXPECT_THAT(TextError(Repeated("<joint/>", most + 1)), HasSubstr("joints"));
  EXPECT_EQ(TextError(Repeated("<jointed/>", most + 1)), "");
}

TEST(UrdfTextTest, SizeIsBounded) {
  EXPECT_EQ(TextError(std::string(limits::kMaxUrdfBytes, ' ')), "");
  EXPECT_THAT(TextError(std::string(limits::kMaxUrdfBytes + 1, ' ')),
              HasSubstr("size of the URDF"));
  EXPECT_THAT(TextError(std::string("<robot/>\0<a>", 12)), HasSubstr("byte 0"));
}

TEST(UrdfTextTest, TextThatEndsInTheMiddlePasses) {
  for (const char* text : {"<", "<a", "<a x='", "<!--", "<![CDATA[", "</", "<?",
                           "a < b", "", ">"}) {
    EXPECT_EQ(TextError(text), "") << text;
  }
}

}  // namespace
}  // namespace tactus::internal::client
