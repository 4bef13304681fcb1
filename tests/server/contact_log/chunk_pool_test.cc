#include "server/contact_log/chunk_pool.h"

#include <algorithm>
#include <cstring>
#include <set>
#include <thread>
#include <vector>

#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal::server {
namespace {

TEST(ChunkPoolTest, GivesEachChunkOnce) {
  for (const size_t chunks : {1, 2, 3, 17, 100}) {
    ChunkPool pool(chunks);
    EXPECT_EQ(pool.free(), chunks);
    std::set<int> taken;
    for (size_t i = 0; i < chunks; ++i) {
      const int chunk = pool.Take();
      ASSERT_GE(chunk, 0);
      ASSERT_LT(chunk, static_cast<int>(chunks));
      EXPECT_TRUE(taken.insert(chunk).second) << chunk << " came twice";
      EXPECT_EQ(pool.free(), chunks - i - 1);
    }
    for (int i = 0; i < 3; ++i) EXPECT_EQ(pool.Take(), ChunkPool::kNone);
    EXPECT_EQ(pool.free(), 0u);
    // One that is given is there again, and only that one.
    const int given = static_cast<int>(chunks) / 2;
    pool.Give(given);
    EXPECT_EQ(pool.Take(), given);
    EXPECT_EQ(pool.Take(), ChunkPool::kNone);
    for (const int chunk : taken) pool.Give(chunk);
    EXPECT_EQ(pool.free(), chunks);
  }
}

TEST(ChunkPoolTest, ChunksDoNotOverlap) {
  constexpr int kChunks = 5;
  ChunkPool pool(kChunks);
  std::vector<int> taken;
  for (int i = 0; i < kChunks; ++i) {
    taken.push_back(pool.Take());
    const auto bytes = pool.bytes(taken.back());
    ASSERT_EQ(bytes.size(), limits::kRecordingChunkBytes);
    std::ranges::fill(bytes, static_cast<uint8_t>(i + 1));
  }
  for (int i = 0; i < kChunks; ++i) {
    const auto bytes = pool.bytes(taken[i]);
    EXPECT_EQ(std::ranges::count(bytes, i + 1), std::ssize(bytes)) << i;
  }
}

// Random takes and gives of one thread against a set of what is free.
TEST(ChunkPoolTest, IsAStackOfWhatIsFree) {
  constexpr size_t kChunks = 9;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    ChunkPool pool(kChunks);
    std::vector<int> taken;
    for (int step = 0; step < 500; ++step) {
      if (random.Uniform() < 0.5) {
        const int chunk = pool.Take();
        ASSERT_EQ(chunk == ChunkPool::kNone, taken.size() == kChunks);
        if (chunk == ChunkPool::kNone) continue;
        ASSERT_EQ(std::ranges::count(taken, chunk), 0);
        taken.push_back(chunk);
      } else if (!taken.empty()) {
        std::swap(taken[random.Index(taken.size())], taken.back());
        pool.Give(taken.back());
        taken.pop_back();
      }
      ASSERT_EQ(pool.free(), kChunks - taken.size());
    }
  }
}

// Four threads share fewer chunks than they want. Whoever has a chunk marks it
// and finds his mark when he gives it: nobody else has had it. ThreadSanitizer
// sees that what one wrote before Give is there for the next after Take.
TEST(ChunkPoolTest, ThreadsNeverShareAChunk) {
  constexpr int kThreads = 4;
  constexpr int kSteps = 20'000;
  constexpr size_t kChunks = 6;
  ChunkPool pool(kChunks);
  for (int i = 0; i < static_cast<int>(kChunks); ++i) {
    std::ranges::fill(pool.bytes(i).first(sizeof(uint64_t)), uint8_t{0});
  }
  std::atomic<int> faults = 0;
  std::atomic<uint64_t> uses = 0;
  std::vector<std::thread> threads;
  for (uint64_t thread = 0; thread < kThreads; ++thread) {
    threads.emplace_back([&, thread] {
      Random random = Random::ForStream(7, thread);
      std::vector<std::pair<int, uint64_t>> mine;
      uint64_t taken = 0;
      const auto count_of = [&](int chunk) {
        uint64_t count = 0;
        std::memcpy(&count, pool.bytes(chunk).data(), sizeof count);
        return count;
      };
      for (int step = 0; step < kSteps; ++step) {
        if (random.Uniform() < 0.5) {
          const int chunk = pool.Take();
          if (chunk == ChunkPool::kNone) continue;
          // Without a lock: each use counts in the chunk itself.
          const uint64_t count = count_of(chunk) + 1;
          std::memcpy(pool.bytes(chunk).data(), &count, sizeof count);
          mine.emplace_back(chunk, count);
          ++taken;
        } else if (!mine.empty()) {
          const auto [chunk, count] = mine.back();
          if (count_of(chunk) != count) ++faults;
          mine.pop_back();
          pool.Give(chunk);
        }
      }
      for (const auto& [chunk, count] : mine) {
        if (count_of(chunk) != count) ++faults;
        pool.Give(chunk);
      }
      uses += taken;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(faults, 0);
  EXPECT_EQ(pool.free(), kChunks);
  // No use was lost.
  uint64_t counted = 0;
  for (size_t i = 0; i < kChunks; ++i) {
    uint64_t count = 0;
    std::memcpy(&count, pool.bytes(pool.Take()).data(), sizeof count);
    counted += count;
  }
  EXPECT_EQ(counted, uses);
  EXPECT_EQ(pool.Take(), ChunkPool::kNone);
}

}  // namespace
}  // namespace tactus::internal::server
