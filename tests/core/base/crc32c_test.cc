#include "core/base/crc32c.h"

#include <string>

#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

// One bit after another, with the reversed polynomial 0x82f63b78 (RFC 3385).
uint32_t BitByBit(const std::string& bytes) {
  uint32_t crc = ~0u;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0x82f63b78u : 0);
    }
  }
  return ~crc;
}

TEST(Crc32cTest, PublishedValues) {
  EXPECT_EQ(ExtendCrc32c(0, ""), 0u);
  EXPECT_EQ(ExtendCrc32c(0, "123456789"), 0xe3069283u);
  // RFC 3720, B.4, read as little-endian numbers.
  EXPECT_EQ(ExtendCrc32c(0, std::string(32, '\0')), 0x8a9136aau);
  EXPECT_EQ(ExtendCrc32c(0, std::string(32, '\xff')), 0x62a8ab43u);
}

TEST(Crc32cTest, PiecesGiveTheSame) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    std::string bytes(random.Index(300), '\0');
    for (char& c : bytes) c = static_cast<char>(random.Index(256));
    const size_t cut = random.Index(bytes.size() + 1);
    const uint32_t first = ExtendCrc32c(0, bytes.substr(0, cut));
    EXPECT_EQ(ExtendCrc32c(first, bytes.substr(cut)), BitByBit(bytes));
    EXPECT_EQ(ExtendCrc32c(0, bytes), BitByBit(bytes));
  }
}

}  // namespace
}  // namespace tactus::internal
