#include "core/store/blob_store.h"

#include <thread>

#include "core/base/errors.h"
#include "core/base/sha256.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/crash_file_system.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using testing::CrashFileSystem;
using ::testing::IsEmpty;
using Loss = CrashFileSystem::Loss;

class BlobStoreTest : public ::testing::Test {
 protected:
  std::unique_ptr<BlobStore> Open() {
    auto blobs = BlobStore::Open(files_, folder_ / "blobs");
    EXPECT_TRUE(blobs.ok()) << blobs.status();
    return *std::move(blobs);
  }
  // The SHA-256; empty after an error.
  static std::string Store(BlobStore& blobs, const std::string& bytes) {
    BlobStore::Batch batch = blobs.NewBatch();
    const auto sha256 = batch.Add(bytes);
    return sha256.ok() && batch.Commit().ok() ? *sha256 : "";
  }

  ScratchDir folder_;
  CrashFileSystem files_;
};

TEST_F(BlobStoreTest, KeepsBytesUnderTheirSha256) {
  auto blobs = Open();
  const std::string sha256 = Store(*blobs, "abc");
  // FIPS 180-2, B.1.
  EXPECT_EQ(sha256,
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  blobs = Open();
  EXPECT_TRUE(*blobs->Has(sha256));
  EXPECT_EQ(*blobs->Read(sha256, 3), "abc");
  EXPECT_EQ(ReasonOf(blobs->Read(sha256, 2).status()), "DATA_LOST");
  EXPECT_EQ(*blobs->List(), std::vector<std::string>{sha256});
  EXPECT_TRUE(blobs->Remove(sha256).ok());
  EXPECT_TRUE(blobs->Remove(sha256).ok());
  EXPECT_FALSE(*blobs->Has(sha256));
  EXPECT_EQ(ReasonOf(blobs->Read(sha256, 3).status()), "DATA_LOST");
}

TEST_F(BlobStoreTest, StoresTheSameBytesOnce) {
  auto blobs = Open();
  BlobStore::Batch batch = blobs->NewBatch();
  const std::string first = *batch.Add("same");
  EXPECT_EQ(*batch.Add("same"), first);
  EXPECT_EQ(*batch.Add("other"), Sha256Hex("other"));
  EXPECT_EQ(batch.added(), 2u);
  ASSERT_TRUE(batch.Commit().ok());
  const auto time = std::filesystem::last_write_time(blobs->PathOf(first));
  BlobStore::Batch again = blobs->NewBatch();
  EXPECT_EQ(*again.Add("same"), first);
  EXPECT_EQ(again.added(), 0u);
  ASSERT_TRUE(again.Commit().ok());
  EXPECT_EQ(std::filesystem::last_write_time(blobs->PathOf(first)), time);
  EXPECT_EQ(blobs->List()->size(), 2u);
}

TEST_F(BlobStoreTest, EveryFlippedBitIsDataLost) {
  auto blobs = Open();
  const std::string bytes = "eleven byte";
  const std::string sha256 = Store(*blobs, bytes);
  for (size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::string flipped = bytes;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << bit % 8));
    WriteBytes(blobs->PathOf(sha256), flipped);
    EXPECT_EQ(ReasonOf(blobs->Read(sha256, 100).status()), "DATA_LOST");
  }
}

TEST_F(BlobStoreTest, DraftsAreRemoved) {
  auto blobs = Open();
  {
    BlobStore::Batch batch = blobs->NewBatch();
    ASSERT_TRUE(batch.Add("never committed").ok());
    EXPECT_EQ(files_.List(folder_ / "blobs/drafts")->size(), 1u);
    EXPECT_THAT(*blobs->List(), IsEmpty());
  }
  EXPECT_THAT(*files_.List(folder_ / "blobs/drafts"), IsEmpty());
  WriteBytes(folder_ / "blobs/drafts/left", "by a crash");
  Open();
  EXPECT_THAT(*files_.List(folder_ / "blobs/drafts"), IsEmpty());
}

// A blob whose name was visible before the disk had it: the next batch that
// adds it must not take it for durable.
TEST_F(BlobStoreTest, AKnownBlobIsOnDiskAfterCommit) {
  auto blobs = Open();
  // Write, sync, rename, sync: the last one fails.
  files_.FailAt(4, IoError("disk", "error"));
  EXPECT_EQ(Store(*blobs, "abc"), "");
  ASSERT_TRUE(files_.failed());
  ASSERT_TRUE(*blobs->Has(Sha256Hex("abc"))) << "the test's assumption";
  EXPECT_EQ(Store(*blobs, "abc"), Sha256Hex("abc"));
  files_.Lose(Loss::kNames);
  EXPECT_EQ(*blobs->Read(Sha256Hex("abc"), 3), "abc");
}

// For each operation and loss: a blob that is there has all its bytes, and one
// whose Commit returned OK is there.
TEST_F(BlobStoreTest, CrashAtEachOperation) {
  int points = 0;
  for (const Loss loss : CrashFileSystem::kLosses) {
    bool reached = true;
    for (int k = 1; reached; ++k) {
      std::filesystem::remove_all(folder_ / "blobs");
      files_.Heal();
      auto blobs = Open();
      files_.StopAt(k);
      std::vector<std::string> stored;
      for (const char* bytes : {"first", "second", "first", "third"}) {
        const std::string sha256 = Store(*blobs, bytes);
        if (!sha256.empty()) stored.push_back(sha256);
      }
      reached = files_.failed();
      files_.Lose(loss);
      files_.Heal();
      blobs = Open();
      for (const std::string& sha256 : stored) {
        EXPECT_TRUE(*blobs->Has(sha256)) << "operation " << k;
      }
      const std::vector<std::string> all = *blobs->List();
      for (const std::string& sha256 : all) {
        EXPECT_TRUE(blobs->Read(sha256, 100).ok()) << "operation " << k;
      }
      ++points;
    }
  }
  RecordProperty("points", points);
  EXPECT_GT(points, 40);
}

TEST_F(BlobStoreTest, ManyThreadsStoreTheSameBytes) {
  auto blobs = Open();
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 20; ++i) {
        EXPECT_EQ(Store(*blobs, std::to_string(i)),
                  Sha256Hex(std::to_string(i)));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  const std::vector<std::string> all = *blobs->List();
  EXPECT_EQ(all.size(), 20u);
  for (const std::string& sha256 : all) {
    EXPECT_TRUE(blobs->Read(sha256, 2).ok());
  }
}

}  // namespace
}  // namespace tactus::internal
