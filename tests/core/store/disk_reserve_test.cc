#include "core/store/disk_reserve.h"

#include <sys/stat.h>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

constexpr int64_t kBytes = 1 << 20;

class DiskReserveTest : public ::testing::Test {
 protected:
  // Bytes that the file takes on the disk.
  int64_t Taken() const {
    struct stat info = {};
    return stat(path_.c_str(), &info) == 0 ? info.st_blocks * 512 : 0;
  }

  ScratchDir folder_;
  const std::string path_ = folder_ / "reserve";
  DiskReserve reserve_{PosixFileSystem(), path_, kBytes};
};

TEST_F(DiskReserveTest, TakesRoom) {
  reserve_.Renew();
  EXPECT_GE(Taken(), kBytes);
  EXPECT_TRUE(reserve_.Check().ok());
}

// As a tool for back-ups copies it.
TEST_F(DiskReserveTest, FillsHoles) {
  WriteBytes(path_, "");
  ASSERT_EQ(truncate(path_.c_str(), kBytes), 0);
  reserve_.Renew();
  EXPECT_GE(Taken(), kBytes);
}

TEST_F(DiskReserveTest, WorkThatFindsTheDiskFullGetsTheRoom) {
  reserve_.Renew();
  int calls = 0;
  EXPECT_TRUE(reserve_
                  .With([&]() -> absl::Status {
                    if (++calls == 1) return StorageFull("disk", "no room");
                    EXPECT_EQ(Taken(), 0);
                    return absl::OkStatus();
                  })
                  .ok());
  EXPECT_EQ(calls, 2);
  EXPECT_GE(Taken(), kBytes) << "it is taken again";
}

TEST_F(DiskReserveTest, OtherErrorsAndSuccessNeedNoRoom) {
  reserve_.Renew();
  for (const absl::Status& status :
       {absl::OkStatus(), IoError("disk", "error")}) {
    int calls = 0;
    EXPECT_EQ(reserve_.With([&] {
      ++calls;
      EXPECT_GE(Taken(), kBytes);
      return status;
    }),
              status);
    EXPECT_EQ(calls, 1);
  }
}

// The disk has no room for this.
TEST_F(DiskReserveTest, WithoutRoomForItselfItRefusesOthers) {
  DiskReserve large(PosixFileSystem(), path_, int64_t{1} << 55);
  EXPECT_EQ(ReasonOf(large.Check()), "STORAGE_FULL");
  EXPECT_THAT(std::string(large.Check().message()),
              HasSubstr("trainctl datasets delete"));
}

TEST_F(DiskReserveTest, IsASmallPartOfADisk) {
  EXPECT_LE(ReserveBytes("/", 0), 32 << 20);
  EXPECT_GE(ReserveBytes("/", 1L << 60), ReserveBytes("/", 0));
  EXPECT_LT(ReserveBytes("/", 1L << 60), 1L << 60);
}

}  // namespace
}  // namespace tactus::internal
