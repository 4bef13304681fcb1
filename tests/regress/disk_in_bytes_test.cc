// trainctl doctor printed "78365671424 bytes are free".
#include "core/store/data_check.h"
#include "core/store/data_directory.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

TEST(DiskInBytesTest, DoctorPrintsUnits) {
  const ScratchDir folder;
  ASSERT_TRUE(DataDirectory::Open(PosixFileSystem(), folder.path()).ok());
  const auto results = CheckData(
      PosixFileSystem(), folder.path(),
      {.free_bytes = [](const std::string&) { return 78'365'671'424; }});
  for (const CheckResult& result : results) {
    if (result.check == "free disk") {
      EXPECT_EQ(result.text, "78.4 GB are free");
      return;
    }
  }
  FAIL() << "no check of the free disk";
}

}  // namespace
}  // namespace tactus::internal
