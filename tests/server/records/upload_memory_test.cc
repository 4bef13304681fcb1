#include <fstream>

#include "gtest/gtest.h"
#include "tests/server/records/stores.h"

namespace tactus::internal::server {
namespace {

// The process's largest resident memory since ForgetPeak, KiB.
int64_t PeakKib() {
  std::ifstream in("/proc/self/status");
  for (std::string word; in >> word;) {
    int64_t kib = 0;
    if (word == "VmHWM:" && in >> kib) return kib;
  }
  return -1;
}

void ForgetPeak() { std::ofstream("/proc/self/clear_refs") << "5"; }

TEST(UploadMemoryTest, SixtyFourMebibytesTakeLessThanSixteen) {
  const ScratchDir folder;
  Stores stores(&PosixFileSystem(), folder / "data");
  ASSERT_TRUE(stores.datasets->Create(kDataset, "", kCaller).ok());
  const auto upload = stores.uploads->Create(kDataset, "", false, kCaller);
  // Trials of half a mebibyte each.
  constexpr int kFrames = 16'000;
  constexpr int64_t kSize = 64L << 20;
  // The first one shows what one trial takes.
  ASSERT_TRUE(stores.Upload(Packed(testing::SmallTrial(-3, kFrames))).ok());
  ForgetPeak();
  const int64_t before = PeakKib();
  ASSERT_GT(before, 0);
  auto writer = *stores.uploads->Write(upload->name(), kCaller);
  uint32_t crc = 0;
  int64_t size = 0;
  int trials = 0;
  for (; size < kSize; ++trials) {
    const std::string bytes = Packed(testing::SmallTrial(trials, kFrames));
    ASSERT_TRUE(writer->Append(size, bytes, ExtendCrc32c(0, bytes)).ok());
    crc = ExtendCrc32c(crc, bytes);
    size += static_cast<int64_t>(bytes.size());
  }
  ASSERT_TRUE(writer->Commit().ok());
  writer.reset();
  uint32_t known = 0;
  const auto version =
      stores.uploads->Finish(upload->name(), size, crc, kCaller, &known);
  ASSERT_TRUE(version.ok()) << version.status();
  EXPECT_EQ(version->trials(), static_cast<uint32_t>(trials) + 1);
  const int64_t growth = PeakKib() - before;
  RecordProperty("growth_kib", static_cast<int>(growth));
  std::printf("%d trials, %ld KiB of memory\n", trials, growth);
  EXPECT_LT(growth, 16 * 1024);
}

}  // namespace
}  // namespace tactus::internal::server
