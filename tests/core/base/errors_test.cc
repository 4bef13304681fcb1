#include "core/base/errors.h"

#include <set>

#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(ErrorsTest, CarryReasonThingValueAndRemedy) {
  const absl::Status status =
      InvalidConfig("sample_rate_hz", -5, "above 0 and at most 10000");
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(status.message(),
            "sample_rate_hz is -5; it must be above 0 and at most 10000");
  const v1::ErrorInfo info = InfoOf(status);
  EXPECT_EQ(info.reason(), "INVALID_CONFIG");
  EXPECT_EQ(info.domain(), "tactus");
  EXPECT_EQ(info.metadata().at("field"), "sample_rate_hz");
  EXPECT_EQ(info.metadata().at("value"), "-5");
  EXPECT_EQ(info.metadata().at("expected"), "above 0 and at most 10000");
}

TEST(ErrorsTest, EqualErrorsCompareEqual) {
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(TimeRegression(3, 2, 1), TimeRegression(3, 2, 1));
  }
}

TEST(ErrorsTest, AnnotationKeepsCodeAndReason) {
  const absl::Status status = Annotate(BundleVersion(2, 1), "a.tactus");
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(ReasonOf(status), "BUNDLE_VERSION");
  EXPECT_EQ(status.message().substr(0, 10), "a.tactus: ");
  EXPECT_TRUE(Annotate(absl::OkStatus(), "a.tactus").ok());
}

TEST(ErrorsTest, OtherStatusesHaveNoReason) {
  EXPECT_EQ(ReasonOf(absl::OkStatus()), "");
  EXPECT_EQ(ReasonOf(absl::InternalError("x")), "");
}

// The reasons are the wire's; AIP-193 allows 63 characters of UPPER_SNAKE.
TEST(ErrorsTest, EveryReasonIsWellFormed) {
  std::set<std::string> seen;
  const auto* values = v1::ErrorReason_descriptor();
  for (int i = 1; i < values->value_count(); ++i) {
    const auto reason =
        static_cast<v1::ErrorReason>(values->value(i)->number());
    const std::string name =
        ReasonOf(MakeError(absl::StatusCode::kInternal, reason, "m"));
    EXPECT_FALSE(name.empty());
    EXPECT_LE(name.size(), 63u);
    EXPECT_EQ(name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_"),
              std::string::npos)
        << name;
    EXPECT_TRUE(seen.insert(name).second) << name;
  }
}

}  // namespace
}  // namespace tactus::internal
