// Edits of datasets: requests that are repeated, quotas, and disks.
#include "core/base/errors.h"
#include "core/base/sha256.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/records/quotas.h"
#include "tests/server/records/stores.h"

namespace tactus::internal::server {
namespace {

v1::RelabelTrialsRequest Relabelling(const std::string& id,
                                     const std::string& label = "X") {
  v1::RelabelTrialsRequest request;
  request.set_dataset(kDataset);
  request.add_trials("trial-0");
  request.set_label(label);
  request.set_reason("typo");
  request.set_request_id(id);
  return request;
}

class DatasetEditsTest : public ::testing::Test {
 protected:
  void Open(const Quotas& quotas = {}) {
    stores_ = std::make_unique<Stores>(&PosixFileSystem(), folder_ / "data", "",
                                       quotas);
    ASSERT_TRUE(stores_->datasets->Create(kDataset, "", kCaller).ok());
    ASSERT_TRUE(stores_->Upload(Pack(0, 4)).ok());
  }
  size_t Blobs() { return stores_->data->blobs().List()->size(); }

  ScratchDir folder_;
  std::unique_ptr<Stores> stores_;
};

TEST_F(DatasetEditsTest, ARepeatedRequestMakesOneVersion) {
  Open();
  const auto first = stores_->datasets->Relabel(Relabelling("r"), kCaller);
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_EQ(first->name(), "datasets/d/versions/2");
  EXPECT_EQ(first->added(), 1u);
  EXPECT_EQ(first->removed(), 1u);
  EXPECT_EQ(first->relabelled(), 1u);
  EXPECT_EQ(first->requester(), kCaller.name);
  EXPECT_EQ(first->reason(), "typo");
  EXPECT_EQ(first->change(), v1::DatasetVersion::CHANGE_RELABEL);
  EXPECT_EQ(first->labels().at("X"), 1u);
  EXPECT_EQ(stores_->datasets->Relabel(Relabelling("r"), kCaller)->name(),
            first->name());
  // Another client's request of the same id is another one.
  EXPECT_EQ(
      stores_->datasets->Relabel(Relabelling("r", "Y"), {"other", ""})->name(),
      "datasets/d/versions/3");
  EXPECT_EQ(stores_->datasets->GetHistory(kDataset)->versions.size(), 3u);
}

// A relabelled record has another label, and says who gave it. All else stays.
TEST_F(DatasetEditsTest, ARelabelledRecordKeepsEverythingElse) {
  Open();
  ASSERT_TRUE(stores_->datasets->Relabel(Relabelling(""), kCaller).ok());
  Trial trial = testing::SmallTrial(0, 3);
  v1::TrialRecord record = ToRecord(trial);
  v1::Labelling& labelling = *record.mutable_labelling();
  labelling.set_by(kCaller.name);
  labelling.set_time_ms(stores_->time_ms);
  labelling.set_before(record.label());
  record.set_label("X");
  const std::string want = Sha256Hex(record.SerializeAsString());
  const auto trials =
      stores_->datasets->Trials(*stores_->datasets->Version(kDataset));
  EXPECT_EQ(trials->front().sha256(), want);
  EXPECT_EQ(trials->front().label(), "X");
  EXPECT_EQ(trials->front().labelling().before(), "SU");
}

// Each touch has its own label; the trial's is that of the first.
TEST_F(DatasetEditsTest, ATrialOfTouchesIsNotRelabelled) {
  Open();
  Trial trial = testing::SmallTrial(20, 5);
  trial.id = "trial-x";
  Touch touch;
  touch.label = trial.label;
  trial.touches = {touch, touch};
  const auto uploaded =
      stores_->Upload(testing::Packed(ToRecord(trial).SerializeAsString()));
  ASSERT_TRUE(uploaded.ok()) << uploaded.status();
  v1::RelabelTrialsRequest request = Relabelling("");
  request.set_trials(0, trial.id);
  const auto refused = stores_->datasets->Relabel(request, kCaller);
  EXPECT_EQ(ReasonOf(refused.status()), "INVALID_TRIAL");
  EXPECT_THAT(std::string(refused.status().message()),
              ::testing::HasSubstr("trial-x\" has 2 touches"));
}

TEST_F(DatasetEditsTest, AQuotaThatIsExceededChangesNothing) {
  const auto use = static_cast<int64_t>(Pack(0, 4).size());
  Open({.stored_bytes = use});
  const size_t blobs = Blobs();
  const auto refused = stores_->datasets->Relabel(Relabelling(""), kCaller);
  EXPECT_EQ(ReasonOf(refused.status()), "QUOTA_EXCEEDED");
  EXPECT_EQ(Blobs(), blobs);
  EXPECT_EQ(stores_->datasets->GetHistory(kDataset)->versions.size(), 1u);
  // Another client has a separate quota; removing needs none.
  EXPECT_TRUE(stores_->datasets->Relabel(Relabelling(""), {"other", ""}).ok());
  v1::RemoveTrialsRequest remove;
  remove.set_dataset(kDataset);
  remove.add_trials("trial-1");
  remove.set_reason("broken");
  const auto removed = stores_->datasets->Remove(remove, kCaller);
  ASSERT_TRUE(removed.ok()) << removed.status();
  EXPECT_EQ(removed->added_bytes(), 0);
  EXPECT_EQ(removed->trials(), 3u);
}

// What an upload brings and the dataset does not take is not kept.
TEST_F(DatasetEditsTest, TrialsThatAreLeftOutLeaveNoBlob) {
  Open();
  const size_t blobs = Blobs();
  Trial trial = testing::SmallTrial(0, 3);
  trial.id = "other";
  const auto version = stores_->Upload(Packed(trial));
  ASSERT_TRUE(version.ok()) << version.status();
  EXPECT_EQ(version->duplicates(), 1u);
  EXPECT_EQ(version->added(), 0u);
  EXPECT_EQ(Blobs(), blobs);
  // A renamed one is stored once, under its new id.
  trial = testing::SmallTrial(9, 3);
  trial.id = "trial-0";
  ASSERT_EQ(stores_->Upload(Packed(trial))->renamed(), 1u);
  // The trial and the list of the new version.
  EXPECT_EQ(Blobs(), blobs + 2);
}

}  // namespace
}  // namespace tactus::internal::server
