// Where the files of imports lie, and where they never do.
#include "tools/console/import_files.h"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits_console.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"
#include "tools/console/import_target.h"
#include "tools/console/private_folder.h"

namespace tactus::internal::console {
namespace {

namespace fs = std::filesystem;

class ImportFilesTest : public ::testing::Test {
 protected:
  // The reason why a file is refused; empty if it is not.
  std::string Open(const std::string& name, int64_t bytes = 1) {
    const auto file = files_->Open(name, bytes);
    if (file.ok()) close(*file);
    return ReasonOf(file.status());
  }

  const ScratchDir folder_;
  const std::unique_ptr<ImportFiles> files_ =
      *ImportFiles::Make(folder_ / "one");
};

TEST_F(ImportFilesTest, FilesHaveTheirNamesInAFolder) {
  EXPECT_EQ(Open("a b.csv"), "");
  EXPECT_EQ(Open("day 1/frames/gr\xC3\xBCn.npy"), "");
  EXPECT_EQ(Open("day 1/frames/b.npy"), "");
  EXPECT_TRUE(files_->Has("day 1/frames/b.npy"));
  EXPECT_FALSE(files_->Has("b.npy"));
  EXPECT_TRUE(fs::exists(files_->Source() + "/day 1/frames/b.npy"));
  EXPECT_EQ(fs::status(files_->Source() + "/a b.csv").permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(ImportFilesTest, NamesLeadNowhereElse) {
  for (const std::string& name :
       {std::string(""), std::string("."), std::string(".."),
        std::string("../a"), std::string("a/../../b"), std::string("/etc/a"),
        std::string("a//b"), std::string("a/"), std::string(".hidden"),
        std::string("a/.b"), std::string("-flag"), std::string("a/--out=b"),
        std::string("a\0b", 3), std::string("a\nb"), std::string("\xff"),
        std::string("a/b/c/d/e/f/g/h/i"),
        std::string(limits::kMaxImportNamePartBytes + 1, 'a')}) {
    EXPECT_EQ(Open(name), "INVALID_CONFIG") << name;
  }
  EXPECT_EQ(std::distance(fs::recursive_directory_iterator(folder_.path()), {}),
            2);
}

TEST_F(ImportFilesTest, AFileIsNoFolderAndNoOtherFile) {
  EXPECT_EQ(Open("a"), "");
  EXPECT_EQ(Open("a"), "INVALID_CONFIG");
  EXPECT_EQ(Open("a/b"), "IO");
  EXPECT_EQ(Open("c/d"), "");
  EXPECT_EQ(Open("c"), "IO");
}

// Nothing makes links there; if something did, they lead nowhere.
TEST_F(ImportFilesTest, LinksAreNotFollowed) {
  fs::create_symlink(folder_ / "target", files_->Source() + "/link");
  fs::create_directory(folder_ / "other");
  fs::create_symlink(folder_ / "other", files_->Source() + "/dir");
  EXPECT_EQ(Open("link"), "IO");
  EXPECT_EQ(Open("dir/a"), "IO");
  EXPECT_FALSE(fs::exists(folder_ / "target"));
  EXPECT_TRUE(fs::is_empty(folder_ / "other"));
}

TEST_F(ImportFilesTest, FilesAreNotTooLargeAndNotTooMany) {
  EXPECT_EQ(Open("large", limits::kMaxImportFileBytes + 1), "INVALID_CONFIG");
  EXPECT_EQ(Open("a", limits::kMaxImportFileBytes), "");
  EXPECT_EQ(Open("b", limits::kMaxImportBytes - limits::kMaxImportFileBytes),
            "");
  EXPECT_EQ(Open("c", 1), "INVALID_CONFIG");
  for (int i = 2; i < limits::kMaxImportFiles; ++i) {
    ASSERT_EQ(Open(absl::StrCat("d", i), 0), "");
  }
  EXPECT_EQ(Open("e", 0), "INVALID_CONFIG");
}

TEST(PrivateFolderTest, IsForNobodyElseAndGoes) {
  const ScratchDir parent;
  std::string path;
  {
    const auto folder = *PrivateFolder::Make(parent.path());
    path = folder->path();
    EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_all);
    WriteBytes(path + "/file", "x");
  }
  EXPECT_FALSE(fs::exists(path));
  EXPECT_EQ(ReasonOf(PrivateFolder::Make(parent / "nothing").status()), "IO");
}

TEST(PrivateFolderTest, RemovesThoseOfProcessesThatCrashed) {
  const ScratchDir parent;
  fs::create_directories(parent / "tactus-console-crashd/1/files");
  WriteBytes(parent / "tactus-console-crashd/1/files/a.csv", "x");
  fs::create_directory(parent / "others");
  const auto first = *PrivateFolder::Make(parent.path());
  EXPECT_FALSE(fs::exists(parent / "tactus-console-crashd"));
  // That of a process that runs stays.
  const auto second = *PrivateFolder::Make(parent.path());
  EXPECT_TRUE(fs::exists(first->path()));
  EXPECT_TRUE(fs::exists(parent / "others"));
  EXPECT_EQ(parent.files(), 3u);
}

TEST(PrivateFolderTest, FollowsNoLink) {
  const ScratchDir parent;
  fs::create_directory(parent / "else");
  WriteBytes(parent / "else/kept", "x");
  fs::create_symlink(parent / "else", parent / "tactus-console-linked");
  const auto folder = *PrivateFolder::Make(parent.path());
  EXPECT_TRUE(fs::exists(parent / "else/kept"));
}

TEST(ImportTargetTest, FindsTheStepAndItsParts) {
  const auto target =
      FindImportStep("/api/import/3/file?id=7f&name=day%201%2Fa%25.csv");
  ASSERT_TRUE(target.has_value());
  EXPECT_EQ(target->step, ImportStep::kFile);
  EXPECT_EQ(target->server, 3u);
  EXPECT_EQ(target->id, "7f");
  EXPECT_EQ(target->name, "day 1/a%.csv");
  EXPECT_FALSE(target->replaces);
  EXPECT_TRUE(FindImportStep("/api/import/0/begin?replace=1")->replaces);
  for (const char* other :
       {"/api/import", "/api/import/", "/api/import/0", "/api/import/0/",
        "/api/import/0/go", "/api/import/-1/begin", "/api/import/100/begin",
        "/api/import/0/begin/x", "/api/import/0/file?name=%2",
        "/api/import/0/file?name=%zz", "/api/import/0/file?path=a",
        "/api/imports/0/begin"}) {
    EXPECT_FALSE(FindImportStep(other).has_value()) << other;
  }
}

}  // namespace
}  // namespace tactus::internal::console
