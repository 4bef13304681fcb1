#include "tests/support/crash_file_system.h"

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::testing {
namespace {

using Loss = CrashFileSystem::Loss;

// A file "a" with "1234" on disk, then "5678" without a sync.
void WriteHalf(CrashFileSystem& files, const std::string& path) {
  auto file = *files.Append(path);
  ASSERT_TRUE(file->Append("1234").ok());
  ASSERT_TRUE(file->Sync().ok());
  ASSERT_TRUE(files.SyncDirectory(path.substr(0, path.rfind('/'))).ok());
  ASSERT_TRUE(file->Append("5678").ok());
}

TEST(CrashFileSystemTest, LosesWhatWasNotSynced) {
  const std::pair<Loss, const char*> cases[] = {{Loss::kNothing, "12345678"},
                                                {Loss::kUnsynced, "1234"},
                                                {Loss::kTorn, "123456"},
                                                {Loss::kNames, "1234"}};
  for (const auto& [loss, left] : cases) {
    const ScratchDir folder;
    CrashFileSystem files;
    WriteHalf(files, folder / "a");
    EXPECT_EQ(files.operations(), 4);
    files.Lose(loss);
    EXPECT_EQ(ReadBytes(folder / "a"), left);
  }
}

TEST(CrashFileSystemTest, LosesNames) {
  const ScratchDir folder;
  CrashFileSystem files;
  for (const char* name : {"old", "new", "gone"}) {
    WriteBytes(folder / name, name);
  }
  ASSERT_TRUE(files.Rename(folder / "new", folder / "old").ok());
  ASSERT_TRUE(files.Remove(folder / "gone").ok());
  ASSERT_TRUE(files.Append(folder / "made").ok());
  files.Lose(Loss::kNames);
  for (const char* name : {"old", "new", "gone"}) {
    EXPECT_EQ(ReadBytes(folder / name), name);
  }
  EXPECT_EQ(folder.files(), 3u);
  ASSERT_TRUE(files.Rename(folder / "new", folder / "old").ok());
  ASSERT_TRUE(files.SyncDirectory(folder.path()).ok());
  files.Lose(Loss::kNames);
  EXPECT_EQ(ReadBytes(folder / "old"), "new");
}

TEST(CrashFileSystemTest, FailsOnceOrForEver) {
  const ScratchDir folder;
  CrashFileSystem files;
  files.FailAt(2, StorageFull("disk", "no room"));
  auto file = *files.Append(folder / "a");
  EXPECT_TRUE(file->Append("1").ok());
  EXPECT_EQ(ReasonOf(file->Append("23")), "STORAGE_FULL");
  EXPECT_TRUE(file->Append("4").ok());
  EXPECT_EQ(ReadBytes(folder / "a"), "124") << "half of a write stays";
  files.StopAt(1);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(ReasonOf(file->Sync()), "IO");
  EXPECT_TRUE(files.failed());
  files.Heal();
  EXPECT_TRUE(file->Sync().ok());
}

}  // namespace
}  // namespace tactus::internal::testing
