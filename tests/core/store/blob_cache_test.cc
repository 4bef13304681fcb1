#include "core/store/blob_cache.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <list>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/sha256.h"
#include "core/store/blob_store.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/crash_file_system.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using testing::CrashFileSystem;

constexpr int64_t kLimit = int64_t{1} << 20;

class BlobCacheTest : public ::testing::Test {
 protected:
  std::unique_ptr<BlobCache> OpenCache(int64_t max_bytes) {
    auto cache = BlobCache::Open(files_, CacheFolder(), max_bytes);
    EXPECT_TRUE(cache.ok()) << cache.status();
    return *std::move(cache);
  }
  std::string CacheFolder() const { return folder_ / "cache"; }
  // Bytes of all files in the folder, drafts too, whoever counts them.
  int64_t BytesOnDisk() const {
    int64_t bytes = 0;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(CacheFolder())) {
      if (entry.is_regular_file() && entry.path().filename() != "lock") {
        bytes += static_cast<int64_t>(entry.file_size());
      }
    }
    return bytes;
  }
  static std::string KeepIn(BlobCache& cache, const std::string& bytes) {
    std::string sha256 = Sha256Hex(bytes);
    cache.Keep(sha256, bytes);
    return sha256;
  }

  ScratchDir folder_;
  CrashFileSystem files_;
};

TEST_F(BlobCacheTest, FindsWhatItKept) {
  auto cache = OpenCache(100);
  const std::string abc = KeepIn(*cache, "abc");
  EXPECT_EQ(cache->Find(abc, 3), "abc");
  EXPECT_EQ(cache->Find(abc, 2), std::nullopt);
  EXPECT_EQ(cache->Find(Sha256Hex("abd"), 3), std::nullopt);
  const std::string empty = KeepIn(*cache, "");
  EXPECT_EQ(cache->Find(empty, 0), "");
  cache.reset();
  cache = OpenCache(100);
  EXPECT_EQ(cache->Find(abc, 3), "abc");
  EXPECT_EQ(cache->Find(empty, 0), "");
  cache->Remove(abc);
  cache->Remove(abc);
  EXPECT_EQ(cache->Find(abc, 3), std::nullopt);
  EXPECT_EQ(BytesOnDisk(), 0);
}

TEST_F(BlobCacheTest, EvictsTheLeastRecentlyUsed) {
  constexpr uint64_t kSeed = 20261128;
  SCOPED_TRACE(absl::StrCat("seed ", kSeed));
  constexpr int64_t kMost = 1000;
  auto cache = OpenCache(kMost);
  Random random(kSeed);
  std::vector<std::string> blobs;
  for (int i = 0; i < 30; ++i) {
    blobs.emplace_back(random.Index(301), static_cast<char>('a' + i));
  }
  // The same by a list that is searched from its end.
  std::list<std::string> expected;
  const auto expected_bytes = [&] {
    size_t bytes = 0;
    for (const std::string& blob : expected) bytes += blob.size();
    return static_cast<int64_t>(bytes);
  };
  for (int step = 0; step < 2000; ++step) {
    const std::string& blob = blobs[random.Index(30)];
    const auto found = cache->Find(Sha256Hex(blob), kLimit);
    const auto place = std::ranges::find(expected, blob);
    ASSERT_EQ(found.has_value(), place != expected.end()) << "step " << step;
    if (found.has_value()) {
      ASSERT_EQ(*found, blob);
      expected.erase(place);
    } else {
      KeepIn(*cache, blob);
    }
    expected.push_back(blob);
    while (expected_bytes() > kMost) expected.pop_front();
    ASSERT_EQ(BytesOnDisk(), expected_bytes()) << "step " << step;
  }
  EXPECT_EQ(cache->totals().bytes, expected_bytes());
  EXPECT_EQ(cache->totals().damaged, 0);
}

TEST_F(BlobCacheTest, ABlobThatIsTooLargeEvictsNothing) {
  auto cache = OpenCache(10);
  const std::string abc = KeepIn(*cache, "abc");
  const std::string large = KeepIn(*cache, "eleven byte");
  EXPECT_EQ(cache->Find(large, kLimit), std::nullopt);
  EXPECT_EQ(cache->Find(abc, 3), "abc");
}

TEST_F(BlobCacheTest, ACopyThatIsDamagedIsMissing) {
  auto cache = OpenCache(1000);
  const std::string bytes(100, 'x');
  const std::string sha256 = Sha256Hex(bytes);
  const std::string path = absl::StrCat(CacheFolder(), "/", sha256);
  const std::function<void()> damages[] = {
      [&] { std::fstream(path).seekp(50).put('y'); },
      [&] { std::filesystem::resize_file(path, 99); },
      [&] { std::filesystem::remove(path); },
      [&] {
        std::filesystem::remove(path);
        std::filesystem::create_symlink("/etc/hostname", path);
      },
  };
  for (const auto& damage : damages) {
    KeepIn(*cache, bytes);
    ASSERT_EQ(cache->Find(sha256, kLimit), bytes);
    damage();
    EXPECT_EQ(cache->Find(sha256, kLimit), std::nullopt);
    EXPECT_FALSE(std::filesystem::exists(path));
  }
  EXPECT_EQ(cache->totals().damaged, 4);
  EXPECT_EQ(cache->totals().bytes, 0);
}

TEST_F(BlobCacheTest, LessRoomAtTheNextStartEvicts) {
  auto cache = OpenCache(1000);
  for (int i = 0; i < 10; ++i) KeepIn(*cache, std::string(100, 'a' + i));
  EXPECT_EQ(BytesOnDisk(), 1000);
  cache.reset();
  cache = OpenCache(250);
  EXPECT_EQ(BytesOnDisk(), 200);
  EXPECT_EQ(cache->totals().blobs, 2);
}

TEST_F(BlobCacheTest, BelongsToOneProcess) {
  const auto cache = OpenCache(1000);
  EXPECT_EQ(ReasonOf(BlobCache::Open(files_, CacheFolder(), 1000).status()),
            "IO");
}

// What the machine loses in a crash is found missing or damaged, never wrong,
// and no draft takes room for ever.
TEST_F(BlobCacheTest, SurvivesACrashAtEachOperation) {
  for (const auto loss : CrashFileSystem::kLosses) {
    for (int stop = 1;; ++stop) {
      SCOPED_TRACE(
          absl::StrCat("stops at ", stop, ", loses ", static_cast<int>(loss)));
      std::filesystem::remove_all(CacheFolder());
      CrashFileSystem files;
      const auto open = [&] {
        return BlobCache::Open(files, CacheFolder(), 250);
      };
      files.StopAt(stop);
      std::vector<std::string> kept;
      if (const auto cache = open(); cache.ok()) {
        for (int i = 0; i < 6; ++i) {
          kept.push_back(std::string(70 + i, static_cast<char>('a' + i)));
          KeepIn(**cache, kept.back());
        }
      }
      const bool done = !files.failed();
      files.Lose(loss);
      files.Heal();
      const auto opened = open();
      ASSERT_TRUE(opened.ok()) << opened.status();
      const auto& cache = *opened;
      EXPECT_LE(BytesOnDisk(), 250);
      for (const std::string& blob : kept) {
        const auto found = cache->Find(Sha256Hex(blob), kLimit);
        if (found.has_value()) {
          EXPECT_EQ(*found, blob);
          continue;
        }
        KeepIn(*cache, blob);
        EXPECT_EQ(cache->Find(Sha256Hex(blob), kLimit), blob);
        EXPECT_LE(BytesOnDisk(), 250);
      }
      if (done) break;
    }
  }
}

TEST_F(BlobCacheTest, ADiskThatFailsIsNoErrorOfAReader) {
  auto cache = OpenCache(250);
  const std::string kept = KeepIn(*cache, std::string(100, 'k'));
  files_.StopAt(1);
  const std::string lost = KeepIn(*cache, std::string(100, 'l'));
  EXPECT_EQ(cache->Find(lost, kLimit), std::nullopt);
  EXPECT_EQ(cache->Find(kept, kLimit), std::string(100, 'k'));
  // What cannot be removed still takes room.
  cache->Remove(kept);
  files_.Heal();
  KeepIn(*cache, std::string(200, 'm'));
  EXPECT_LE(BytesOnDisk(), 250);
}

TEST_F(BlobCacheTest, SeveralThreadsKeepAndFind) {
  auto cache = OpenCache(2000);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      Random random(static_cast<uint64_t>(t) + 1);
      for (int step = 0; step < 500; ++step) {
        const auto i = random.Index(20);
        const std::string blob(200 + i, static_cast<char>('a' + i));
        const auto found = cache->Find(Sha256Hex(blob), kLimit);
        if (found.has_value()) {
          EXPECT_EQ(*found, blob);
        } else {
          KeepIn(*cache, blob);
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_LE(BytesOnDisk(), 2000);
  EXPECT_EQ(cache->totals().bytes, BytesOnDisk());
}

class CachedBlobStoreTest : public BlobCacheTest {
 protected:
  std::unique_ptr<BlobStore> OpenStore() {
    auto blobs = BlobStore::OpenShared(files_, folder_ / "blobs", "1");
    EXPECT_TRUE(blobs.ok()) << blobs.status();
    (*blobs)->UseCache(OpenCache(1000));
    return *std::move(blobs);
  }
  static std::string StoreIn(BlobStore& blobs, const std::string& bytes) {
    BlobStore::Batch batch = blobs.NewBatch();
    const auto sha256 = batch.Add(bytes);
    EXPECT_TRUE(batch.Commit().ok());
    return *sha256;
  }
};

TEST_F(CachedBlobStoreTest, ReadsABlobOnceFromTheSharedFolder) {
  const auto blobs = OpenStore();
  const std::string sha256 = StoreIn(*blobs, "abc");
  EXPECT_EQ(*blobs->Read(sha256, 3), "abc");
  std::filesystem::remove(blobs->PathOf(sha256));
  EXPECT_EQ(*blobs->Read(sha256, 3), "abc");
  EXPECT_EQ(blobs->cache()->totals().found, 1);
  EXPECT_TRUE(blobs->Remove(sha256).ok());
  EXPECT_EQ(ReasonOf(blobs->Read(sha256, 3).status()), "DATA_LOST");
}

TEST_F(CachedBlobStoreTest, ADamagedBlobIsNotKept) {
  const auto blobs = OpenStore();
  const std::string sha256 = StoreIn(*blobs, "abc");
  std::ofstream(blobs->PathOf(sha256)) << "abd";
  EXPECT_EQ(ReasonOf(blobs->Read(sha256, 3).status()), "DATA_LOST");
  EXPECT_EQ(blobs->cache()->totals().blobs, 0);
}

// An upload replaces a damaged blob, for the servers that have no copy.
TEST_F(CachedBlobStoreTest, ACopyDoesNotHideADamagedBlob) {
  const auto blobs = OpenStore();
  const std::string sha256 = StoreIn(*blobs, "abc");
  EXPECT_EQ(*blobs->Read(sha256, 3), "abc");
  std::ofstream(blobs->PathOf(sha256)) << "abd";
  EXPECT_EQ(StoreIn(*blobs, "abc"), sha256);
  EXPECT_EQ(*ReadBlobFile(files_, blobs->PathOf(sha256), sha256, 3), "abc");
}

}  // namespace
}  // namespace tactus::internal
