#include "server/contact_log/recording_bytes.h"

#include <sys/resource.h>
#include <zlib.h>

#include <algorithm>
#include <vector>

#include "core/base/errors.h"
#include "core/base/limits_contact_log.h"
#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal::server {
namespace {

constexpr size_t kLargestRecording =
    limits::kMaxRecordingChunks * limits::kRecordingChunkBytes;

// Half noise, half the same byte.
std::string SomeBytes(uint64_t seed, size_t size) {
  Random random(seed);
  std::string bytes(size, 'a');
  for (size_t i = 0; i < size; i += 2) {
    bytes[i] = static_cast<char>(random.Index(256));
  }
  return bytes;
}

// What a stranger's program may have deflated, at the best level.
std::string DeflatedByZlib(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string deflated(size, '\0');
  EXPECT_EQ(compress2(reinterpret_cast<Bytef*>(deflated.data()), &size,
                      reinterpret_cast<const Bytef*>(bytes.data()),
                      bytes.size(), Z_BEST_COMPRESSION),
            Z_OK);
  deflated.resize(size);
  return deflated;
}

// The largest memory that the process ever had.
int64_t PeakMemoryBytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return int64_t{usage.ru_maxrss} * 1024;
}

void ExpectLost(const std::string& deflated, size_t size) {
  const auto bytes = Inflated(deflated, size);
  ASSERT_FALSE(bytes.ok()) << size;
  EXPECT_EQ(ReasonOf(bytes.status()), "DATA_LOST");
}

TEST(RecordingBytesTest, ComeBackAsTheyWere) {
  for (const size_t size :
       {size_t{0}, size_t{1}, size_t{1000}, kLargestRecording}) {
    const std::string bytes = SomeBytes(size + 1, size);
    const std::string deflated = Deflated(bytes);
    const auto again = Inflated(deflated, size);
    ASSERT_TRUE(again.ok()) << again.status();
    EXPECT_TRUE(*again == bytes) << size;
  }
  EXPECT_LT(Deflated(std::string(10'000, 'x')).size(), 200u);
}

TEST(RecordingBytesTest, AnyDeflaterWillDo) {
  const std::string bytes = SomeBytes(3, 5000);
  const auto again = Inflated(DeflatedByZlib(bytes), bytes.size());
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_TRUE(*again == bytes);
}

TEST(RecordingBytesTest, AnotherSizeIsRefused) {
  const std::string bytes = SomeBytes(4, 5000);
  const std::string deflated = Deflated(bytes);
  for (const size_t size : {0, 1, 4999, 5001, 100'000}) {
    ExpectLost(deflated, size);
  }
}

TEST(RecordingBytesTest, CutAndChangedBytesAreRefused) {
  const std::string bytes = SomeBytes(5, 600);
  const std::string deflated = Deflated(bytes);
  for (size_t size = 0; size < deflated.size(); ++size) {
    ExpectLost(deflated.substr(0, size), bytes.size());
  }
  // Its checksum finds each changed byte, and most are found earlier.
  for (size_t i = 0; i < deflated.size(); ++i) {
    std::string changed = deflated;
    changed[i] = static_cast<char>(changed[i] ^ 0x10);
    const auto again = Inflated(changed, bytes.size());
    EXPECT_FALSE(again.ok() && *again != bytes) << i;
    // The header's flags say nothing of the bytes.
    EXPECT_FALSE(again.ok() && i >= 2) << i;
  }
  ExpectLost(bytes, bytes.size());
}

// 256 MiB in some 1 MB, whatever they say to be.
TEST(RecordingBytesTest, ABombTakesNoMemory) {
  constexpr size_t kBomb = size_t{256} << 20;
  std::string bomb;
  {
    // Deflated piece by piece, so that the test needs no memory for it either.
    std::string piece(1 << 20, '\0');
    z_stream stream = {};
    ASSERT_EQ(deflateInit(&stream, Z_BEST_SPEED), Z_OK);
    std::string out(1 << 20, '\0');
    for (size_t done = 0; done <= kBomb; done += piece.size()) {
      stream.next_in = reinterpret_cast<Bytef*>(piece.data());
      stream.avail_in = done == kBomb ? 0 : piece.size();
      stream.next_out = reinterpret_cast<Bytef*>(out.data());
      stream.avail_out = out.size();
      deflate(&stream, done == kBomb ? Z_FINISH : Z_NO_FLUSH);
      bomb.append(out, 0, out.size() - stream.avail_out);
    }
    deflateEnd(&stream);
  }
  ASSERT_LT(bomb.size(), size_t{2} << 20);
  const int64_t before = PeakMemoryBytes();
  ExpectLost(bomb, kBomb);
  ExpectLost(bomb, SIZE_MAX);
  ExpectLost(bomb, kLargestRecording + 1);
  ExpectLost(bomb, kLargestRecording);
  ExpectLost(bomb, 100);
  ExpectLost(bomb, 0);
  constexpr int64_t kLittle = int64_t{32} << 20;
  EXPECT_LT(PeakMemoryBytes() - before, kLittle);
}

}  // namespace
}  // namespace tactus::internal::server
