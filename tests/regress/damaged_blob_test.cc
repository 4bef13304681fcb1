// A folder, a link or a pipe in the place of a blob was an error that clients
// repeat for ever (UNAVAILABLE), or the call never ended. A dataset whose
// manifest was damaged could not be deleted.
#include <sys/stat.h>

#include <filesystem>

#include "core/base/errors.h"
#include "core/base/sha256.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/records/stores.h"

namespace tactus::internal::server {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class DamagedBlobTest : public ::testing::Test {
 protected:
  static constexpr int kKinds = 12;

  DamagedBlobTest() : stores_(&PosixFileSystem(), folder_ / "data") {
    EXPECT_TRUE(stores_.datasets->Create(kDataset, "", kCaller).ok());
    EXPECT_TRUE(stores_.Upload(Pack(0, 3)).ok());
    version_ = *stores_.datasets->Version(kDataset);
    trial_ = stores_.datasets->Trials(version_)->front().sha256();
  }
  // Damages a blob in one of kKinds ways, and puts it back when destroyed.
  class Damage {
   public:
    Damage(const std::string& path, int kind)
        : path_(path), bytes_(ReadBytes(path)) {
      WriteBytes(path_ + ".copy", bytes_);
      fs::remove(path_);
      Replace(kind);
    }
    ~Damage() {
      if (!fs::is_directory(Shelf())) {
        fs::remove(Shelf());
        fs::rename(Shelf().parent_path() / "shelf", Shelf());
      }
      fs::remove_all(path_);
      fs::remove(path_ + ".copy");
      WriteBytes(path_, bytes_);
    }

   private:
    fs::path Shelf() const { return fs::path(path_).parent_path(); }
    void Replace(int kind) {
      std::string bytes = bytes_;
      switch (kind) {
        case 0:
          return;
        case 1:
          return WriteBytes(path_, "");
        case 2:
          return WriteBytes(path_, bytes_.substr(1));
        case 3:
          return WriteBytes(path_, bytes_ + "x");
        case 4:
          bytes[bytes.size() / 2] ^= 1;
          return WriteBytes(path_, bytes);
        case 5:
          fs::create_directory(path_);
          return;
        case 6:
          return fs::create_symlink(path_ + ".copy", path_);
        case 7:
          return fs::create_symlink("nowhere", path_);
        case 8:
          return fs::create_symlink(path_, path_);
        case 9:
          return fs::create_symlink("/dev/zero", path_);
        case 10:
          EXPECT_EQ(mkfifo(path_.c_str(), 0600), 0);
          return;
        default:
          // The shelf of the blob is a file.
          fs::rename(Shelf(), Shelf().parent_path() / "shelf");
          WriteBytes(Shelf(), "x");
      }
    }

    const std::string path_;
    const std::string bytes_;
  };
  std::string PathOf(const std::string& sha256) const {
    return stores_.data->blobs().PathOf(sha256);
  }

  ScratchDir folder_;
  Stores stores_;
  v1::DatasetVersion version_;
  std::string trial_;
};

TEST_F(DamagedBlobTest, EveryKindOfDamageIsDataLost) {
  for (int kind = 0; kind < kKinds; ++kind) {
    SCOPED_TRACE(kind);
    for (const std::string& sha256 : {trial_, version_.sha256()}) {
      const Damage damage(PathOf(sha256), kind);
      const absl::Status status =
          stores_.data->blobs().Read(sha256, 1 << 20).status();
      EXPECT_TRUE(absl::IsDataLoss(status)) << status;
      EXPECT_EQ(ReasonOf(status), "DATA_LOST");
      EXPECT_THAT(std::string(status.message()),
                  AllOf(HasSubstr(sha256), HasSubstr("from a back-up")));
    }
  }
  EXPECT_EQ(stores_.datasets->Trials(version_)->size(), 3u);
}

TEST_F(DamagedBlobTest, AnUploadReplacesADamagedBlob) {
  for (int kind = 0; kind < kKinds - 1; ++kind) {
    SCOPED_TRACE(kind);
    const Damage damage(PathOf(trial_), kind);
    // Nothing takes the place of a folder.
    if (kind == 5) continue;
    ASSERT_TRUE(stores_.Upload(Pack(0, 3)).ok());
    EXPECT_TRUE(stores_.data->blobs().Read(trial_, 1 << 20).ok());
  }
}

TEST_F(DamagedBlobTest, ADatasetWithADamagedManifestCanBeDeleted) {
  ASSERT_TRUE(stores_.datasets->Create("datasets/e", "", kCaller).ok());
  ASSERT_TRUE(stores_.Upload(Pack(0, 2), false, "datasets/e").ok());
  const Damage damage(PathOf(version_.sha256()), 5);
  // Nobody knows which trials the damaged version has.
  EXPECT_EQ(*stores_.datasets->Delete("datasets/e", kCaller), 0u);
  EXPECT_TRUE(fs::exists(PathOf(trial_)));
  EXPECT_TRUE(stores_.datasets->Delete(kDataset, kCaller).ok());
  EXPECT_FALSE(stores_.datasets->Version(kDataset).ok());
}

}  // namespace
}  // namespace tactus::internal::server
