#include "server/records/dataset_store.h"

#include <set>

#include "core/base/errors.h"
#include "core/base/sha256.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/records/stores.h"

namespace tactus::internal::server {
namespace {

using ::testing::ElementsAre;

class DatasetStoreTest : public ::testing::Test {
 protected:
  DatasetStoreTest() { Create(kDataset); }
  void Create(const char* name) {
    EXPECT_TRUE(stores_.datasets->Create(name, "", kCaller).ok());
  }
  size_t Blobs() { return stores_.data->blobs().List()->size(); }

  ScratchDir folder_;
  Stores stores_{&PosixFileSystem(), folder_ / "data"};
};

// More trials than the reader of a version takes were stored, and the version
// could never be downloaded again.
TEST_F(DatasetStoreTest, AVersionHasAtMostSoManyTrials) {
  const NowMs now = [] { return int64_t{1'700'000'000'000}; };
  stores_.datasets =
      std::make_unique<DatasetStore>(stores_.data.get(), now, Quotas{}, 5);
  stores_.uploads = std::make_unique<UploadStore>(stores_.data.get(),
                                                  stores_.datasets.get(), now);
  ASSERT_TRUE(stores_.Upload(Pack(0, 4)).ok());
  const auto refused = stores_.Upload(Pack(4, 8));
  EXPECT_EQ(ReasonOf(refused.status()), "INVALID_TRIAL");
  EXPECT_THAT(std::string(refused.status().message()),
              ::testing::HasSubstr("would have 8 trials; it may have at most "
                                   "5"));
  EXPECT_EQ(stores_.datasets->Version(kDataset)->trials(), 4u);
  EXPECT_TRUE(stores_.Upload(Pack(4, 9), /*replace=*/true).ok());
}

TEST_F(DatasetStoreTest, VersionsAddReplaceAndCount) {
  struct Case {
    int first, end;
    bool replace;
    uint32_t trials, added, removed;
  };
  const Case cases[] = {{0, 4, false, 4, 4, 0},
                        {2, 6, false, 6, 2, 0},
                        {2, 6, false, 6, 0, 0},
                        {5, 8, true, 3, 2, 5}};
  for (const Case& c : cases) {
    const auto version = stores_.Upload(Pack(c.first, c.end), c.replace);
    ASSERT_TRUE(version.ok()) << version.status();
    EXPECT_EQ(version->trials(), c.trials);
    EXPECT_EQ(version->added(), c.added);
    EXPECT_EQ(version->removed(), c.removed);
  }
  const auto versions = stores_.datasets->GetHistory(kDataset)->versions;
  ASSERT_EQ(versions.size(), 4u);
  EXPECT_EQ(versions.at(1).sha256(), versions.at(2).sha256());
  EXPECT_EQ(stores_.datasets->Version("datasets/d/versions/1")->trials(), 4u);
  EXPECT_EQ(stores_.datasets->Version(kDataset)->trials(), 3u);
  // A version is the hash of its sorted list.
  std::set<std::string> hashes;
  for (int i = 5; i < 8; ++i) {
    hashes.insert(
        Sha256Hex(ToRecord(testing::SmallTrial(i, 3)).SerializeAsString()));
  }
  std::string manifest;
  for (const std::string& hash : hashes) manifest += hash + "\n";
  EXPECT_EQ(versions.back().sha256(), Sha256Hex(manifest));
}

TEST_F(DatasetStoreTest, NamesAndTextsAreChecked) {
  EXPECT_EQ(ReasonOf(stores_.datasets->Create(kDataset, "", kCaller).status()),
            "DATASET_EXISTS");
  for (const char* name :
       {"d", "datasets/", "datasets/D", "datasets/d/versions/1"}) {
    EXPECT_EQ(ReasonOf(stores_.datasets->Create(name, "", kCaller).status()),
              "INVALID_NAME");
  }
  for (const std::string& text :
       {std::string("\xff"), std::string(1025, 'a')}) {
    EXPECT_EQ(
        ReasonOf(
            stores_.datasets->Create("datasets/e", text, kCaller).status()),
        "INVALID_CONFIG");
  }
  for (const char* name : {"datasets/no", "datasets/no/versions/1",
                           "datasets/d/versions/1", kDataset}) {
    EXPECT_EQ(ReasonOf(stores_.datasets->Version(name).status()),
              "DATASET_NOT_FOUND");
  }
}

TEST_F(DatasetStoreTest, ListsInPages) {
  for (const char* name : {"datasets/a", "datasets/c", "datasets/b-2"}) {
    Create(name);
  }
  std::vector<std::string> names;
  std::string token;
  do {
    const auto page = stores_.datasets->List(3, token);
    ASSERT_TRUE(page.ok());
    for (const auto& dataset : page->items) names.push_back(dataset.name());
    token = page->next_token;
  } while (!token.empty());
  EXPECT_THAT(
      names, ElementsAre("datasets/a", "datasets/b-2", "datasets/c", kDataset));
}

TEST_F(DatasetStoreTest, NoFlippedByteOfAManifestIsServed) {
  ASSERT_TRUE(stores_.Upload(Pack(0, 4)).ok());
  const auto version = stores_.datasets->Version(kDataset);
  ASSERT_TRUE(version.ok()) << version.status();
  const std::string path = stores_.data->BlobFolder() + "/" +
                           version->sha256().substr(0, 2) + "/" +
                           version->sha256();
  const std::string good = ReadBytes(path);
  ASSERT_EQ(good.size(), 4u * 65);
  for (size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ (1 << (i % 8)));
    WriteBytes(path, bad);
    const auto trials = stores_.datasets->Trials(*version);
    EXPECT_EQ(ReasonOf(trials.status()), "DATA_LOST") << "byte " << i;
  }
  WriteBytes(path, good);
  EXPECT_EQ(stores_.datasets->Trials(*version)->size(), 4u);
}

TEST_F(DatasetStoreTest, DeletesWhatNobodyElseHolds) {
  Create("datasets/other");
  ASSERT_TRUE(stores_.Upload(Pack(0, 4)).ok());
  ASSERT_TRUE(stores_.Upload(Pack(4, 5)).ok());
  ASSERT_TRUE(stores_.Upload(Pack(2, 6), false, "datasets/other").ok());
  EXPECT_EQ(Blobs(), 6u + 3u);
  const auto removed = stores_.datasets->Delete(kDataset, kCaller);
  ASSERT_TRUE(removed.ok()) << removed.status();
  EXPECT_EQ(*removed, 2u) << "trials 0 and 1";
  EXPECT_EQ(Blobs(), 4u + 1u);
  EXPECT_EQ(ReasonOf(stores_.datasets->Get(kDataset).status()),
            "DATASET_NOT_FOUND");
  EXPECT_EQ(ReasonOf(stores_.datasets->Delete(kDataset, kCaller).status()),
            "DATASET_NOT_FOUND");
  const auto other = stores_.datasets->Version("datasets/other");
  EXPECT_EQ(stores_.datasets->Trials(*other)->size(), 4u);
  // The two datasets' equal versions share a manifest.
  Create(kDataset);
  ASSERT_TRUE(stores_.Upload(Pack(2, 6)).ok());
  ASSERT_TRUE(stores_.datasets->Delete("datasets/other", kCaller).ok());
  EXPECT_EQ(
      stores_.datasets->Trials(*stores_.datasets->Version(kDataset))->size(),
      4u);
}

TEST_F(DatasetStoreTest, ADatasetMadeAgainContinuesTheNumbers) {
  ASSERT_TRUE(stores_.Upload(Pack(0, 1)).ok());
  ASSERT_TRUE(stores_.Upload(Pack(1, 2)).ok());
  // Deleted twice, so that an empty dataset does not forget the numbers.
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(stores_.datasets->Delete(kDataset, kCaller).ok());
    Create(kDataset);
    EXPECT_EQ(stores_.datasets->Get(kDataset)->latest_version(), 0u);
  }
  EXPECT_EQ(stores_.Upload(Pack(2, 3))->name(), "datasets/d/versions/3");
  EXPECT_EQ(stores_.Upload(Pack(3, 4))->name(), "datasets/d/versions/4");
  EXPECT_EQ(stores_.datasets->Version(kDataset)->trials(), 2u);
  EXPECT_EQ(
      ReasonOf(stores_.datasets->Version("datasets/d/versions/1").status()),
      "DATASET_NOT_FOUND");
  Create("datasets/d-2");
  EXPECT_EQ(stores_.Upload(Pack(0, 1), false, "datasets/d-2")->name(),
            "datasets/d-2/versions/1");
}

TEST_F(DatasetStoreTest, IsNotDeletedWhileInUse) {
  ASSERT_TRUE(stores_.Upload(Pack(0, 2)).ok());
  Create("datasets/d-2");
  const auto reason = [&] {
    return ReasonOf(stores_.datasets->Delete(kDataset, kCaller).status());
  };
  v1::Operation job;
  job.mutable_train()->set_dataset_version("datasets/d/versions/1");
  const std::string name = stores_.operations->Create(job, "", kCaller)->name();
  EXPECT_EQ(reason(), "DATASET_IN_USE");
  EXPECT_TRUE(stores_.datasets->Delete("datasets/d-2", kCaller).ok())
      << "a name that begins alike";
  ASSERT_TRUE(stores_.operations
                  ->Change(name,
                           [](v1::Operation& operation) {
                             operation.set_state(v1::Operation::STATE_FAILED);
                             return absl::OkStatus();
                           })
                  .ok());
  v1::ModelVersion origin;
  origin.mutable_train()->set_dataset_version("datasets/d/versions/1");
  ASSERT_TRUE(
      stores_.models->AddVersion("models/m", TestBundle(1), origin, kCaller)
          .ok());
  EXPECT_EQ(reason(), "DATASET_IN_USE");
  ASSERT_TRUE(stores_.models->Delete("models/m/versions/1", kCaller).ok());
  v1::UpdateAliasRequest gate;
  gate.set_name("aliases/a");
  gate.mutable_gate()->set_dataset_version("datasets/d/versions/1");
  ASSERT_TRUE(stores_.models->UpdateAlias(gate, kCaller).ok());
  EXPECT_EQ(reason(), "DATASET_IN_USE");
  gate.clear_gate();
  ASSERT_TRUE(stores_.models->UpdateAlias(gate, kCaller).ok());
  EXPECT_EQ(reason(), "");
}

}  // namespace
}  // namespace tactus::internal::server
