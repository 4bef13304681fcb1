#include "server/records/blob_parts.h"

#include "core/base/sha256.h"
#include "gtest/gtest.h"
#include "tests/server/records/stores.h"

namespace tactus::internal::server {
namespace {

constexpr int64_t kLimit = 8L << 20;

class BlobPartsTest : public ::testing::Test {
 protected:
  BlobPartsTest() : stores_(&PosixFileSystem(), folder_ / "data") {}

  std::string Add(const std::string& bytes) {
    BlobStore::Batch batch = stores_.data->blobs().NewBatch();
    const std::string sha256 = *batch.Add(bytes);
    EXPECT_TRUE(batch.Commit().ok());
    return sha256;
  }
  // The blob, put together, or the reason of the error.
  std::string Read(const std::string& sha256, int64_t limit = kLimit) {
    std::string all;
    const absl::Status status = ReadBlobParts(
        *stores_.data, sha256, limit, [&](absl::string_view part) {
          EXPECT_LE(part.size(), size_t{1} << 20);
          all.append(part.data(), part.size());
          return absl::OkStatus();
        });
    return status.ok() ? all : ReasonOf(status);
  }

  const ScratchDir folder_;
  Stores stores_;
};

TEST_F(BlobPartsTest, PartsMakeTheBlob) {
  for (const size_t size : {0, 1, 1 << 20, (1 << 20) + 1, 5 << 19}) {
    std::string bytes(size, 'a');
    for (size_t i = 0; i < size; i += 7) bytes[i] = static_cast<char>(i / 7);
    EXPECT_TRUE(Read(Add(bytes)) == bytes) << size;
  }
}

TEST_F(BlobPartsTest, NoPartOfADamagedBlobIsHandedOut) {
  const std::string sha256 = Add(std::string(3 << 20, 'a'));
  std::ofstream(stores_.data->blobs().PathOf(sha256),
                std::ios::binary | std::ios::in | std::ios::out)
          .seekp(2 << 20)
      << 'b';
  bool taken = false;
  const absl::Status status =
      ReadBlobParts(*stores_.data, sha256, kLimit, [&](absl::string_view) {
        taken = true;
        return absl::OkStatus();
      });
  EXPECT_EQ(ReasonOf(status), "DATA_LOST");
  EXPECT_FALSE(taken);
}

TEST_F(BlobPartsTest, RefusesLargeAndMissingBlobs) {
  EXPECT_EQ(Read(Add(std::string(3 << 20, 'a')), 2 << 20), "DATA_LOST");
  EXPECT_EQ(Read(Add("ab"), 1), "DATA_LOST");
  EXPECT_EQ(Read(Sha256Hex("none")), "DATA_LOST");
}

}  // namespace
}  // namespace tactus::internal::server
