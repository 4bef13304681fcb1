#include "client/stream/message_ring.h"

#include <cstring>
#include <deque>
#include <string>

#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal::client {
namespace {

bool Push(MessageRing& ring, const std::string& record) {
  char* const bytes = ring.Append(record.size());
  if (bytes == nullptr) return false;
  std::memcpy(bytes, record.data(), record.size());
  return true;
}

// Beside a deque of strings.
TEST(MessageRingTest, IsAQueueOfAnyRecords) {
  Random random(3);
  MessageRing ring(200'000);
  EXPECT_LE(ring.capacity(), 131'072u);
  std::deque<std::string> model;
  int full = 0;
  for (int i = 0; i < 50'000; ++i) {
    const size_t size = random.Index(random.Index(20) == 0 ? 9'000 : 300);
    std::string record(size, static_cast<char>(i));
    if (Push(ring, record)) {
      model.push_back(std::move(record));
    } else {
      ++full;
      EXPECT_GT(ring.bytes() + 2 * (size + 16), ring.capacity());
    }
    // Sometimes it shrinks, sometimes it grows.
    const size_t pops = random.Index(i / 1'000 % 2 == 0 ? 2 : 4);
    for (size_t p = 0; p < pops && !model.empty(); ++p) {
      model.pop_front();
      ring.PopFront();
    }
    ASSERT_EQ(ring.empty(), model.empty());
    if (i % 100 != 0) continue;
    auto at = ring.begin();
    for (const std::string& want : model) {
      ASSERT_EQ(ring.At(at), want);
      at = ring.Next(at);
    }
    ASSERT_EQ(at, ring.end());
  }
  EXPECT_GT(full, 100);
  EXPECT_EQ(ring.capacity(), 131'072u);
  ring.Clear();
  EXPECT_TRUE(ring.empty());
  EXPECT_EQ(ring.bytes(), 0u);
}

TEST(MessageRingTest, RefusesWhatNeverFits) {
  MessageRing ring(1'024);
  EXPECT_FALSE(Push(ring, std::string(1'024, 'a')));
  EXPECT_TRUE(Push(ring, std::string(1'008, 'a')));
  EXPECT_FALSE(Push(ring, "b"));
  EXPECT_TRUE(Push(ring, std::string(0, 'a')));
}

}  // namespace
}  // namespace tactus::internal::client
