// 150 bytes of a Zarr array asked for 8e14 bytes of chunks that are absent,
// and the import worked for hours.
#include <filesystem>
#include <string>

#include "core/base/errors.h"
#include "core/files/zarr.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

void WriteArray(const std::string& folder, const std::string& sizes) {
  std::filesystem::create_directories(folder);
  WriteBytes(folder + "/.zarray",
             R"({"zarr_format": 2, "order": "C", "filters": null,
                 "compressor": null, "fill_value": 0, "dtype": "|u1", )" +
                 sizes + "}");
}

TEST(ZarrChunksBeyondTheirArrayTest, WholeChunksCount) {
  const ScratchDir dir;
  WriteBytes(dir / ".zgroup", R"({"zarr_format": 2})");
  // 80 chunks of 16 MiB for 80 bytes.
  WriteArray(dir / "a", R"("shape": [80, 1], "chunks": [1, 16777216])");
  const absl::Status status = ReadZarr(dir.path()).status();
  EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("has 80 bytes in 80 chunks of 16777216"));
}

TEST(ZarrChunksBeyondTheirArrayTest, ArraysOfAGroupCountTogether) {
  const ScratchDir dir;
  WriteBytes(dir / ".zgroup", R"({"zarr_format": 2})");
  for (int i = 0; i < 80; ++i) {
    WriteArray(dir / ("a" + std::to_string(i)),
               R"("shape": [1], "chunks": [16777216])");
  }
  EXPECT_EQ(ReasonOf(ReadZarr(dir.path()).status()), "TRIAL_FILE_INVALID");
}

// One chunk that is longer than the array is how zarr writes short arrays.
TEST(ZarrChunksBeyondTheirArrayTest, OneLongChunkIsRead) {
  const ScratchDir dir;
  WriteBytes(dir / ".zgroup", R"({"zarr_format": 2})");
  WriteArray(dir / "a", R"("shape": [3], "chunks": [1000])");
  const auto arrays = ReadZarr(dir.path());
  ASSERT_TRUE(arrays.ok()) << arrays.status();
  EXPECT_EQ(arrays->at("a").shape, std::vector<size_t>{3});
}

}  // namespace
}  // namespace tactus::internal
