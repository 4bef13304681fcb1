#include "core/contacts/trained_on.h"

#include <algorithm>

#include "core/base/limits.h"
#include "core/base/sha256.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

class TrainedOnTest : public ::testing::Test {
 protected:
  // Contacts with the fingerprints of the numbers `first` to `end` - 1.
  std::vector<const LabelledContact*> Contacts(int first, int end,
                                               bool known = true) {
    std::vector<LabelledContact>& made = made_.emplace_back(end - first);
    std::vector<const LabelledContact*> pointers;
    for (int i = first; i < end; ++i) {
      if (known) made[i - first].fingerprint = Sha256Hex(std::to_string(i));
      pointers.push_back(&made[i - first]);
    }
    return pointers;
  }

  std::vector<std::vector<LabelledContact>> made_;
};

TEST_F(TrainedOnTest, ComparesFrames) {
  Provenance provenance;
  SetTrainedOn(Contacts(0, 100), provenance);
  EXPECT_EQ(provenance.trial_fingerprints.size(), 100u);
  EXPECT_TRUE(std::ranges::is_sorted(provenance.trial_fingerprints));
  EXPECT_EQ(provenance.groups, 1u);
  EXPECT_EQ(provenance.conditions, 1u);
  struct Case {
    int first, end, contacts;
  };
  for (const Case c : {Case{0, 100, 100}, Case{20, 30, 10}, Case{90, 110, 10},
                       Case{100, 200, 0}}) {
    // Names and hashes of the data have no say.
    const TrainedOn found =
        FindTrainedOn(provenance, Contacts(c.first, c.end), {.name = ""});
    EXPECT_EQ(found.basis, TrainingBasis::kFrames);
    EXPECT_EQ(found.contacts, c.contacts);
    EXPECT_EQ(found.tested, c.end - c.first);
  }
}

TEST_F(TrainedOnTest, ComparesTheDataIfTheBundleNamesNoTrials) {
  Provenance provenance;
  const auto many = Contacts(0, limits::kMaxProvenanceTrials + 1);
  SetTrainedOn(many, provenance);
  EXPECT_TRUE(provenance.trial_fingerprints.empty());
  provenance.data_sha256 = DataSha256(many);
  TrainedOn found =
      FindTrainedOn(provenance, many, {.sha256 = provenance.data_sha256});
  EXPECT_EQ(found.basis, TrainingBasis::kData);
  EXPECT_EQ(found.contacts, found.tested);
  const auto other = Contacts(0, 3);
  found = FindTrainedOn(provenance, other, {.sha256 = DataSha256(other)});
  EXPECT_EQ(found.basis, TrainingBasis::kData);
  EXPECT_EQ(found.contacts, 0);
  // Simulated contacts have no fingerprints.
  SetTrainedOn(Contacts(0, 3, false), provenance);
  EXPECT_TRUE(provenance.trial_fingerprints.empty());
  EXPECT_EQ(provenance.groups, 0u);
  EXPECT_EQ(DataSha256(Contacts(0, 3, false)), "");
}

TEST_F(TrainedOnTest, BundlesOfEarlierReleasesNameTheirFile) {
  Provenance provenance;
  provenance.data = "arm.h5";
  const auto contacts = Contacts(0, 3);
  const std::string sha256 = DataSha256(contacts);
  TrainedOn found =
      FindTrainedOn(provenance, contacts, {.sha256 = sha256, .name = "arm.h5"});
  EXPECT_EQ(found.basis, TrainingBasis::kName);
  EXPECT_EQ(found.contacts, 3);
  EXPECT_THAT(TrainedOnText(found), HasSubstr("a file of this name"));
  found =
      FindTrainedOn(provenance, contacts, {.sha256 = sha256, .name = "b.h5"});
  EXPECT_EQ(found.basis, TrainingBasis::kUnknown);
  EXPECT_THAT(TrainedOnText(found), HasSubstr("does not say"));
}

}  // namespace
}  // namespace tactus::internal
