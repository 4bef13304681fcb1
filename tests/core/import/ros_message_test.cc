#include "core/import/ros_message.h"

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string Fault(const std::string& definition) {
  const auto type = RosMessageType::Parse(definition);
  EXPECT_EQ(ReasonOf(type.status()), "TRIAL_FILE_INVALID");
  return std::string(type.status().message());
}

TEST(RosMessageTest, ReadsNumbersOfNestedArrays) {
  const auto type = RosMessageType::Parse(
      "# a comment\nuint8 KIND = 3\nPoint[] points\nint16[2] pair # two\n"
      "string name\ntime stamp\n===\nMSG: a/Point\nuint8 x\nint8 y\n");
  ASSERT_TRUE(type.ok()) << type.status();
  const std::string bytes(
      "\2\0\0\0\1\377\3\4\5\0\0\1\2\0\0\0hi\7\0\0\0\0\0\0\0", 26);
  const auto numbers = type->Read(bytes);
  ASSERT_TRUE(numbers.ok()) << numbers.status();
  EXPECT_THAT(numbers->at("points.x"), ElementsAre(1, 3));
  EXPECT_THAT(numbers->at("points.y"), ElementsAre(-1, 4));
  EXPECT_THAT(numbers->at("pair"), ElementsAre(5, 256));
  EXPECT_THAT(numbers->at("stamp"), ElementsAre(7));
  // Any other length is refused.
  for (size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(type->Read(bytes.substr(0, size)).ok()) << size;
  }
  EXPECT_FALSE(type->Read(bytes + "x").ok());
}

TEST(RosMessageTest, BadDefinitionsAreRefused) {
  EXPECT_THAT(Fault("Point point\n"), HasSubstr("\"Point\" of \"point\""));
  EXPECT_THAT(Fault("float64\n"), HasSubstr("\"float64\" is no field"));
  EXPECT_THAT(Fault("float64[x] a\n"), HasSubstr("is no field"));
  // A type within itself.
  const auto type = RosMessageType::Parse("A a\n===\nMSG: p/A\nA a\n");
  ASSERT_TRUE(type.ok());
  EXPECT_THAT(std::string(type->Read("").status().message()),
              HasSubstr("without end"));
}

// A length that the bytes cannot hold costs no memory.
TEST(RosMessageTest, AHugeLengthIsRefused) {
  for (const char* definition :
       {"float64[] a\n", "Empty[] a\n===\nMSG: p/Empty\n"}) {
    const auto type = RosMessageType::Parse(definition);
    ASSERT_TRUE(type.ok());
    EXPECT_FALSE(type->Read("\xff\xff\xff\xff").ok());
  }
}

}  // namespace
}  // namespace tactus::internal
