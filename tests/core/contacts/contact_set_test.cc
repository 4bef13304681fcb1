#include "core/contacts/contact_set.h"

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

LabelledContact OnForearm(const std::string& id) {
  LabelledContact contact;
  contact.id = id;
  contact.layout = *LayoutPreset("cody-forearm");
  return contact;
}

TEST(ContactSetTest, TrialsThatAreUsedTogetherAreAlike) {
  const LabelledContact first = OnForearm("000000");
  EXPECT_TRUE(CheckOneSkin(first, OnForearm("000001")).ok());
  LabelledContact other = OnForearm("000007");
  other.layout.contact_threshold = 0.015;
  absl::Status status = CheckOneSkin(first, other);
  EXPECT_EQ(ReasonOf(status), "INVALID_TRAINING_DATA");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("trial 000007 has contact_threshold 0.015, not 0.01"));
  other = OnForearm("000007");
  other.sample_rate_hz = 50;
  status = CheckOneSkin(first, other);
  EXPECT_EQ(ReasonOf(status), "INVALID_TRAINING_DATA");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("sample_rate_hz 50, not 100"));
}

TEST(ContactSetTest, TrialsFitTheModelThatClassifiesThem) {
  Model model = testing::SmallModel();
  LabelledContact contact = OnForearm("000007");
  contact.layout.onset_threshold = 0.5;
  // It fits any skin.
  EXPECT_TRUE(CheckFits(contact, model).ok());
  model.layout = *LayoutPreset("cody-forearm");
  const absl::Status status = CheckFits(contact, model);
  EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("onset_threshold 0.5, not 0.02"));
  contact.layout.onset_threshold = 0.02;
  EXPECT_TRUE(CheckFits(contact, model).ok());
  contact.sample_rate_hz = 104;
  EXPECT_TRUE(CheckFits(contact, model).ok());
  contact.sample_rate_hz = 106;
  EXPECT_EQ(ReasonOf(CheckFits(contact, model)), "INVALID_CONFIG");
  // Ideal signals have no skin.
  contact = LabelledContact();
  EXPECT_TRUE(CheckFits(contact, model).ok());
}

}  // namespace
}  // namespace tactus::internal
