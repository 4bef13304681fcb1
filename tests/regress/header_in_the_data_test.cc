// Two taxels that always read AA 55 were taken for the header if the line was
// opened in the middle of a frame: all taxels were displaced, without a word.
#include <string>

#include "client/drivers/serial/serial_skin.h"
#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/serial/talking_skin.h"

namespace tactus::internal::client {
namespace {

using testing::AsBytes;
using testing::BinaryFrame;
using ::testing::HasSubstr;
using testing::Values;

constexpr size_t kTaxels = 24;

// `frames` frames whose taxels `stuck` and the one after read AA 55.
std::string Stream(size_t stuck, int frames, Random& random) {
  std::string bytes;
  for (int f = 0; f < frames; ++f) {
    Values values(kTaxels);
    for (uint16_t& value : values) value = random.Index(3);
    values[stuck] = 0xAA;
    values[stuck + 1] = 0x55;
    bytes += BinaryFrame(values);
  }
  return bytes;
}

size_t Delivered(SerialFrames& frames, size_t stuck) {
  Values values;
  int64_t time_ns = 0;
  size_t count = 0;
  while (frames.Next(values, time_ns)) {
    EXPECT_EQ(values[stuck], 0xAA);
    EXPECT_EQ(values[stuck + 1], 0x55);
    ++count;
  }
  return count;
}

TEST(HeaderInTheDataTest, IsToldWhereverTheLineIsOpened) {
  Random random(1);
  for (size_t stuck = 0; stuck + 1 < kTaxels; ++stuck) {
    for (size_t begin = 0; begin < kTaxels + 2; ++begin) {
      SerialFrames frames(SerialFormat::kAa55, 4, 6);
      frames.Add(AsBytes(Stream(stuck, 12, random).substr(begin)), 1);
      EXPECT_EQ(Delivered(frames, stuck), 0u);
      EXPECT_THAT(
          frames.Ambiguity(),
          HasSubstr(absl::StrCat("taxels ", stuck, " and ", stuck + 1)));
      const size_t other = kTaxels - 2 - stuck;
      EXPECT_THAT(
          frames.Ambiguity(),
          HasSubstr(absl::StrCat("taxels ", other, " and ", other + 1)));
    }
  }
}

TEST(HeaderInTheDataTest, AMaskedPairIsNotTakenForTheHeader) {
  Random random(2);
  for (const size_t stuck : {0, 7, 22}) {
    std::vector<uint8_t> mask(kTaxels, 1);
    mask[stuck] = mask[stuck + 1] = 0;
    for (size_t begin = 0; begin < kTaxels + 2; ++begin) {
      SerialFrames frames(SerialFormat::kAa55, 4, 6, mask);
      frames.Add(AsBytes(Stream(stuck, 12, random).substr(begin)), 1);
      EXPECT_GE(Delivered(frames, stuck), 10u);
      EXPECT_EQ(frames.Ambiguity(), "");
    }
  }
}

// A lost byte hides the header for a period, and not the stuck pair.
TEST(HeaderInTheDataTest, LostBytesDoNotMakeTheDataTheHeader) {
  constexpr size_t kStuck = 9;
  for (uint64_t seed = 0; seed < 300; ++seed) {
    Random random(seed);
    std::string bytes = Stream(kStuck, 40, random);
    for (int loss = 0; loss < 4; ++loss) {
      bytes.erase(random.Index(bytes.size() - 8), 1 + random.Index(5));
    }
    SerialFrames frames(SerialFormat::kAa55, 4, 6);
    frames.Add(AsBytes(bytes), 1);
    // A frame whose own bytes were lost cannot be known from a whole one.
    ASSERT_EQ(Delivered(frames, kStuck), 0u) << seed;
  }
}

// Once the header is known, taxels may read anything.
TEST(HeaderInTheDataTest, ComesAfterTheHeaderIsKnown) {
  Random random(3);
  SerialFrames frames(SerialFormat::kAa55, 4, 6);
  for (int f = 0; f < 4; ++f) {
    frames.Add(AsBytes(BinaryFrame(Values(kTaxels, 1))), 1);
  }
  Values values;
  int64_t time_ns = 0;
  while (frames.Next(values, time_ns)) {
  }
  frames.Add(AsBytes(Stream(5, 20, random)), 1);
  frames.Next(values, time_ns);  // the last frame of before
  EXPECT_EQ(Delivered(frames, 5), 19u);
}

}  // namespace
}  // namespace tactus::internal::client
