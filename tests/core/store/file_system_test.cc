#include "core/store/file_system.h"

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class FileSystemTest : public ::testing::Test {
 protected:
  ScratchDir folder_;
  FileSystem& files_ = PosixFileSystem();
};

TEST_F(FileSystemTest, AppendsAtTheEnd) {
  const std::string path = folder_ / "a";
  EXPECT_EQ(*files_.Size(path), -1);
  for (const char* text : {"one", "two"}) {
    auto file = files_.Append(path);
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_TRUE((*file)->Append(text).ok());
    EXPECT_TRUE((*file)->Append("").ok());
    EXPECT_TRUE((*file)->Sync().ok());
  }
  EXPECT_EQ(*files_.Size(path), 6);
  EXPECT_EQ(*files_.Read(path, 2, 3), "etw");
  EXPECT_TRUE(files_.Truncate(path, 4).ok());
  EXPECT_EQ(*ReadWhole(files_, path, 4), "onet");
  EXPECT_THAT(*files_.List(folder_.path()), ElementsAre("a"));
  EXPECT_TRUE(files_.SyncDirectory(folder_.path()).ok());
  EXPECT_TRUE(files_.SyncAll(folder_.path()).ok());
  EXPECT_TRUE(files_.Remove(path).ok());
  EXPECT_TRUE(files_.Remove(path).ok());
}

TEST_F(FileSystemTest, ErrorsNameTheFile) {
  const std::string path = folder_ / "a";
  WriteBytes(path, "12345");
  EXPECT_EQ(ReasonOf(files_.Read(path, 3, 3).status()), "DATA_LOST");
  EXPECT_EQ(ReasonOf(files_.Read(folder_ / "b", 0, 1).status()), "DATA_LOST");
  EXPECT_EQ(ReasonOf(ReadWhole(files_, path, 4).status()), "DATA_LOST");
  EXPECT_EQ(ReasonOf(ReadWhole(files_, folder_ / "b", 4).status()),
            "DATA_LOST");
  for (const absl::Status& status :
       {files_.Append(folder_ / "no/a").status(),
        files_.Rename(folder_ / "b", folder_ / "c"),
        files_.Truncate(folder_ / "b", 0), files_.MakeDirectory("/no/such/a"),
        files_.SyncDirectory(folder_ / "no"), files_.SyncAll(folder_ / "no"),
        files_.List(folder_ / "no").status(), files_.Remove(folder_.path())}) {
    EXPECT_EQ(ReasonOf(status), "IO");
    EXPECT_THAT(std::string(status.message()), HasSubstr("/"));
  }
}

// Somebody who can write to the folder must not redirect the server's writes.
TEST_F(FileSystemTest, DoesNotFollowALink) {
  std::filesystem::create_symlink(folder_ / "target", folder_ / "link");
  EXPECT_EQ(ReasonOf(files_.Append(folder_ / "link").status()), "IO");
  EXPECT_EQ(*files_.Size(folder_ / "target"), -1);
}

TEST_F(FileSystemTest, AFullDeviceIsStorageFull) {
  auto file = files_.Append("/dev/full");
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(ReasonOf((*file)->Append("a")), "STORAGE_FULL");
}

TEST_F(FileSystemTest, WritesAtomically) {
  const std::string path = folder_ / "a";
  WriteBytes(path + ".draft", "left by a crash");
  for (const char* text : {"one", "2", ""}) {
    ASSERT_TRUE(WriteAtomically(files_, path, text).ok());
    EXPECT_EQ(ReadBytes(path), text);
  }
  EXPECT_THAT(*files_.List(folder_.path()), ElementsAre("a"));
}

}  // namespace
}  // namespace tactus::internal
