#include "core/base/wire_check.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tactus/v1/trial.pb.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

WireCheck Check(const std::string& bytes) {
  return CheckWire(*v1::TrialRecord::descriptor(), bytes);
}

v1::TrialRecord Record() {
  v1::TrialRecord record;
  record.set_id("a");
  record.set_stiffness(1);
  for (int i = 0; i < 1'000; ++i) record.add_time(i);
  record.set_taxels(std::string(10'000, 'x'));
  record.mutable_geometry()->set_rows(2);
  for (int i = 0; i < 1'000; ++i) {
    record.mutable_geometry()->add_masked_taxels(i);
  }
  return record;
}

TEST(WireCheckTest, AcceptsWhatTheTypeKnows) {
  EXPECT_EQ(Check("").fault, "");
  EXPECT_EQ(Check(Record().SerializeAsString()).fault, "");
  // A list of numbers one by one, as old writers wrote it.
  EXPECT_EQ(Check(std::string("\x59\0\0\0\0\0\0\0\0", 9)).fault, "");
}

// The bound holds, and is not absurd.
TEST(WireCheckTest, BoundsTheMemoryOfTheMessage) {
  const v1::TrialRecord record = Record();
  v1::TrialRecord parsed;
  ASSERT_TRUE(parsed.ParseFromString(record.SerializeAsString()));
  const int64_t bound = Check(record.SerializeAsString()).parsed_bytes;
  EXPECT_GE(bound, static_cast<int64_t>(parsed.SpaceUsedLong()));
  EXPECT_LE(bound, 4 * static_cast<int64_t>(parsed.SpaceUsedLong()));
}

TEST(WireCheckTest, NamesAnUnknownFieldAtAnyDepth) {
  const std::string unknown = "\x98\x06\x01";
  EXPECT_THAT(Check(Record().SerializeAsString() + unknown).fault,
              HasSubstr("field 99 that tactus.v1.TrialRecord"));
  EXPECT_THAT(Check("\x52\x03" + unknown).fault,
              HasSubstr("field 99 that tactus.v1.SensorGeometry"));
  // Known fields of another type are unknown to the parser.
  EXPECT_THAT(Check("\x08\x01").fault, HasSubstr("field 1 "));
  EXPECT_THAT(Check("\x30\x01").fault, HasSubstr("field 6 "));
}

TEST(WireCheckTest, RefusesWrongEncodings) {
  const std::string good = Record().SerializeAsString();
  EXPECT_NE(Check(good.substr(0, good.size() - 1)).fault, "");
  EXPECT_NE(Check("\xff").fault, "");
  EXPECT_NE(Check("\x0a\xff\xff\xff\xff\x7f").fault, "");
  // A message that claims more bytes than there are, and an end of a group.
  EXPECT_NE(Check("\x52\x7f").fault, "");
  EXPECT_NE(Check("\x0c").fault, "");
}

}  // namespace
}  // namespace tactus::internal
