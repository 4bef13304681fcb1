// On a full disk no dataset could be deleted, so it stayed full, and a server
// did not start.
#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/jobs/training_backend.h"
#include "tests/server/records/old_directory.h"
#include "tests/server/records/stores.h"

namespace tactus::internal::server {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

bool WriteLine(const std::string& path, const std::string& line) {
  const int fd = open(path.c_str(), O_WRONLY);
  if (fd < 0) return false;
  const ssize_t written = write(fd, line.data(), line.size());
  close(fd);
  return written == static_cast<ssize_t>(line.size());
}

// Lets this process mount, which sees what it mounts alone. A user without the
// right gets it within a user namespace, where the kernel allows these.
bool MayMount() {
  if (unshare(CLONE_NEWNS) == 0) return true;
  const std::string user = std::to_string(geteuid());
  const std::string group = std::to_string(getegid());
  return unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0 &&
         WriteLine("/proc/self/setgroups", "deny") &&
         WriteLine("/proc/self/uid_map", user + " " + user + " 1") &&
         WriteLine("/proc/self/gid_map", group + " " + group + " 1");
}

// A file system of 6 MiB that only this process sees. False if it may not.
bool MountSmallDisk(const std::string& folder) {
  return MayMount() &&
         mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
         mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=6m") == 0;
}

// Takes all room that is left, to the last byte.
void FillDisk(const std::string& folder) {
  const int fd =
      open((folder + "/filling").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  ASSERT_GE(fd, 0);
  const std::string bytes(64 * 1024, 'x');
  for (size_t size = bytes.size(); size > 0;) {
    if (write(fd, bytes.data(), size) <= 0) size /= 2;
  }
  close(fd);
}

class FullDiskTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(disk_);
    if (!MountSmallDisk(disk_)) {
      GTEST_SKIP() << "this process may not mount a file system";
    }
    Stores stores(&PosixFileSystem(), path_);
    for (const char* name : {"datasets/d", "datasets/e"}) {
      ASSERT_TRUE(stores.datasets->Create(name, "", kCaller).ok());
    }
    ASSERT_TRUE(stores.Upload(Pack(0, 200)).ok());
    ASSERT_TRUE(stores.Upload(Pack(200, 400), false, "datasets/e").ok());
    ASSERT_TRUE(
        stores.models->AddVersion("models/m", TestBundle(1), {}, kCaller).ok());
  }
  void TearDown() override { umount(disk_.c_str()); }

  // The disk is full and stays so: uploads are refused.
  static void ExpectNoUpload(UploadStore& uploads) {
    const absl::Status status =
        uploads.Create("datasets/e", "", false, kCaller).status();
    EXPECT_TRUE(absl::IsResourceExhausted(status)) << status;
    EXPECT_EQ(ReasonOf(status), "STORAGE_FULL");
    EXPECT_THAT(std::string(status.message()),
                HasSubstr("trainctl datasets delete"));
  }

  ScratchDir folder_;
  const std::string disk_ = folder_ / "disk";
  const std::string path_ = disk_ + "/data";
};

TEST_F(FullDiskTest, ADatasetCanBeDeleted) {
  Stores stores(&PosixFileSystem(), path_);
  FillDisk(disk_);
  ExpectNoUpload(*stores.uploads);
  const auto removed = stores.datasets->Delete(kDataset, kCaller);
  ASSERT_TRUE(removed.ok()) << removed.status();
  EXPECT_EQ(*removed, 200u);
  // Each of the 200 trials had a block.
  EXPECT_GT(fs::space(disk_).available, 400'000u);
  EXPECT_TRUE(stores.Upload(Pack(0, 3), false, "datasets/e").ok());
  // The reserve was renewed: it works again.
  FillDisk(disk_);
  EXPECT_TRUE(stores.models->Delete("models/m/versions/1", kCaller).ok());
  EXPECT_TRUE(stores.datasets->Delete("datasets/e", kCaller).ok());
}

TEST_F(FullDiskTest, AServerStarts) {
  FillDisk(disk_);
  for (int start = 0; start < 3; ++start) {
    SCOPED_TRACE(start);
    ModelRegistry registry;
    ASSERT_TRUE(registry.AddBuiltIn("default", TestBundle(0)).ok());
    const auto backend = TrainingBackend::Open({.folder = path_}, &registry);
    ASSERT_TRUE(backend.ok()) << backend.status();
    EXPECT_TRUE((*backend)->failures().empty());
    EXPECT_TRUE(registry.Find("models/m/versions/1", "").ok());
    ExpectNoUpload((*backend)->uploads());
    FillDisk(disk_);
    if (start == 2) {
      EXPECT_TRUE((*backend)->datasets().Delete(kDataset, kCaller).ok());
      EXPECT_TRUE(
          (*backend)->uploads().Create("datasets/e", "", false, kCaller).ok());
    }
  }
}

// It has no reserve, so its server cannot start until there is room.
TEST_F(FullDiskTest, ADirectoryOfRelease010SaysWhatItNeedsAndLosesNothing) {
  MakeOldDirectory(path_);
  FillDisk(disk_);
  for (int start = 0; start < 3; ++start) {
    SCOPED_TRACE(start);
    const absl::Status status =
        DataDirectory::Open(PosixFileSystem(), path_).status();
    EXPECT_EQ(ReasonOf(status), "STORAGE_FULL") << status;
    EXPECT_THAT(std::string(status.message()),
                HasSubstr("Remove other files from this disk"));
  }
  fs::remove(disk_ + "/filling");
  Stores stores(&PosixFileSystem(), path_);
  EXPECT_EQ(
      stores.datasets->Trials(*stores.datasets->Version(kDataset))->size(),
      200u);
  EXPECT_TRUE(stores.models->Get("models/m/versions/1").ok());
  FillDisk(disk_);
  EXPECT_TRUE(stores.datasets->Delete(kDataset, kCaller).ok());
}

TEST_F(FullDiskTest, AnUploadThatFillsTheDiskIsRefusedAndCanGoOn) {
  Stores stores(&PosixFileSystem(), path_);
  const auto upload =
      stores.uploads->Create("datasets/e", "", false, kCaller)->name();
  const absl::Status status =
      stores.Write(upload, std::string(8 << 20, 'x'), 1 << 18);
  EXPECT_EQ(ReasonOf(status), "STORAGE_FULL") << status;
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("trainctl datasets delete"));
  EXPECT_GT(stores.uploads->Get(upload)->committed_size(), 0);
  EXPECT_TRUE(stores.datasets->Delete(kDataset, kCaller).ok());
}

}  // namespace
}  // namespace tactus::internal::server
