#include "core/store/data_directory.h"

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

class DataDirectoryTest : public ::testing::Test {
 protected:
  absl::StatusOr<std::unique_ptr<DataDirectory>> Open() {
    return DataDirectory::Open(PosixFileSystem(), folder_ / "data");
  }
  ScratchDir folder_;
};

TEST_F(DataDirectoryTest, HasOneUser) {
  auto data = Open();
  ASSERT_TRUE(data.ok()) << data.status();
  const auto second = Open();
  EXPECT_EQ(ReasonOf(second.status()), "IO");
  EXPECT_THAT(std::string(second.status().message()),
              HasSubstr("another process uses this data directory"));
  data->reset();
  EXPECT_TRUE(Open().ok());
}

TEST_F(DataDirectoryTest, PathsLieInTheFolder) {
  auto data = *Open();
  EXPECT_EQ(data->UploadPath("7"), folder_ / "data/uploads/7");
  EXPECT_EQ(data->JobPath("7"), folder_ / "data/jobs/7");
  EXPECT_EQ(data->BlobFolder(), folder_ / "data/blobs");
}

// The records' own pages: Open alone would not read them.
TEST_F(DataDirectoryTest, ADamagedCatalogueIsRefused) {
  {
    auto data = *Open();
    ASSERT_TRUE(data->catalog()
                    .Change([](Transaction& change) {
                      for (int i = 0; i < 200; ++i) {
                        change
                            .Put(Table::kTrials, std::to_string(i),
                                 std::string(200, 'x'))
                            .IgnoreError();
                      }
                      return absl::OkStatus();
                    })
                    .ok());
  }
  const std::string path = folder_ / "data/catalog.db";
  std::string bytes = ReadBytes(path);
  ASSERT_GT(bytes.size(), 4 * 4096u);
  bytes.replace(3 * 4096, 100, 100, '\x7f');
  WriteBytes(path, bytes);
  EXPECT_EQ(ReasonOf(Open().status()), "DATA_LOST");
}

TEST_F(DataDirectoryTest, AFolderThatCannotBeMade) {
  EXPECT_EQ(
      ReasonOf(DataDirectory::Open(PosixFileSystem(), "/no/such").status()),
      "IO");
}

}  // namespace
}  // namespace tactus::internal
