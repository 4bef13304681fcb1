// Results were written to FILE.partial. Two programs could write to it at once,
// and it could be a link to another file. It was renamed before its contents
// were on disk, so after a power failure the bundle could be empty.
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "core/files/draft_file.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"

namespace {

// What was written to the disk, and the target's contents at that time.
struct Sync {
  bool folder;
  std::string target;
};
std::vector<Sync> syncs;
std::string watched;

}  // namespace

// Takes the place of the C library's function in this program.
extern "C" int fsync(int fd) {
  struct stat info = {};
  fstat(fd, &info);
  if (!watched.empty()) {
    syncs.push_back(
        {S_ISDIR(info.st_mode), tactus::internal::ReadBytes(watched)});
  }
  return static_cast<int>(syscall(SYS_fsync, fd));
}

namespace tactus::internal {
namespace {

namespace fs = std::filesystem;

TEST(DraftThatFollowsALinkTest, EveryDraftHasItsOwnFile) {
  const ScratchDir dir;
  auto first = DraftFile::Create(dir / "a");
  auto second = DraftFile::Create(dir / "a");
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_NE(first->path(), second->path());
  WriteBytes(first->path(), "first");
  WriteBytes(second->path(), "second");
  EXPECT_FALSE(fs::exists(dir / "a"));
  ASSERT_TRUE(first->Publish().ok());
  EXPECT_EQ(ReadBytes(dir / "a"), "first");
  ASSERT_TRUE(second->Publish().ok());
  EXPECT_EQ(ReadBytes(dir / "a"), "second");
  EXPECT_EQ(dir.files(), 1u);
}

TEST(DraftThatFollowsALinkTest, AFileInTheWayIsLeftAlone) {
  const ScratchDir dir;
  const std::string path = DraftFile::Create(dir / "a")->path();
  // The next number: a draft that a program of the same id left behind.
  const size_t dash = path.rfind('-');
  const int number = std::stoi(path.substr(dash + 1));
  const std::string next =
      path.substr(0, dash + 1) + std::to_string(number + 1) + ".tmp";
  WriteBytes(dir / "precious", "precious");
  fs::create_symlink(dir / "precious", next);
  ASSERT_TRUE(WriteFileBytes(dir / "a", "new").ok());
  EXPECT_EQ(ReadBytes(dir / "a"), "new");
  EXPECT_EQ(ReadBytes(dir / "precious"), "precious");
}

TEST(DraftThatFollowsALinkTest, IsOnDiskBeforeItHasItsName) {
  const ScratchDir dir;
  ASSERT_TRUE(WriteFileBytes(dir / "a", "old").ok());
  syncs.clear();
  watched = dir / "a";
  ASSERT_TRUE(WriteFileBytes(dir / "a", "new").ok());
  watched.clear();
  ASSERT_EQ(syncs.size(), 2u);
  EXPECT_FALSE(syncs[0].folder);
  EXPECT_EQ(syncs[0].target, "old");
  EXPECT_TRUE(syncs[1].folder);
  EXPECT_EQ(syncs[1].target, "new");
}

TEST(DraftThatFollowsALinkTest, DevicesAndFoldersAreNotReplaced) {
  const ScratchDir dir;
  ASSERT_EQ(mkfifo((dir / "fifo").c_str(), 0600), 0);
  fs::create_directory(dir / "folder");
  for (const std::string& path : {dir / "fifo", dir / "folder"}) {
    EXPECT_EQ(ReasonOf(WriteFileBytes(path, "new")), "IO");
  }
  EXPECT_TRUE(fs::is_fifo(dir / "fifo"));
  EXPECT_EQ(dir.files(), 2u);
  EXPECT_EQ(ReasonOf(WriteFileBytes(dir / "absent/a", "new")), "IO");
}

TEST(DraftThatFollowsALinkTest, AFailureLeavesTheTargetAsItWas) {
  const ScratchDir dir;
  WriteBytes(dir / "a", "old");
  {
    auto draft = DraftFile::Create(dir / "a");
    ASSERT_TRUE(draft.ok());
    WriteBytes(draft->path(), "half");
  }
  EXPECT_EQ(ReadBytes(dir / "a"), "old");
  EXPECT_EQ(dir.files(), 1u);
}

}  // namespace
}  // namespace tactus::internal
