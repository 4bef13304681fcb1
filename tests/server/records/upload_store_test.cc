#include "server/records/upload_store.h"

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/random.h"
#include "core/base/sha256.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/records/stores.h"

namespace tactus::internal::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class UploadStoreTest : public ::testing::Test {
 protected:
  UploadStoreTest() {
    EXPECT_TRUE(stores_->datasets->Create(kDataset, "", kCaller).ok());
  }
  void Reopen() {
    stores_.reset();
    stores_ = std::make_unique<Stores>(&files_, folder_ / "data");
  }
  std::string NewUpload(const std::string& request = "") {
    const auto upload =
        stores_->uploads->Create(kDataset, request, false, kCaller);
    EXPECT_TRUE(upload.ok()) << upload.status();
    return upload->name();
  }
  static absl::Status Append(UploadStore::Writer& writer, int64_t offset,
                             const std::string& bytes) {
    return writer.Append(offset, bytes, ExtendCrc32c(0, bytes));
  }
  // What is on disk of the only upload's bytes.
  int64_t Committed(const std::string& name) {
    return stores_->uploads->Get(name)->committed_size();
  }

  ScratchDir folder_;
  testing::CrashFileSystem files_;
  std::unique_ptr<Stores> stores_ =
      std::make_unique<Stores>(&files_, folder_ / "data");
  const std::string pack_ = Pack(0, 6);
};

TEST_F(UploadStoreTest, BecomesAVersion) {
  const std::string name = NewUpload();
  ASSERT_TRUE(stores_->Write(name, pack_, 100).ok());
  uint32_t known = 7;
  const auto version =
      stores_->uploads->Finish(name, static_cast<int64_t>(pack_.size()),
                               ExtendCrc32c(0, pack_), kCaller, &known);
  ASSERT_TRUE(version.ok()) << version.status();
  EXPECT_EQ(known, 0u);
  EXPECT_EQ(version->name(), "datasets/d/versions/1");
  EXPECT_EQ(version->trials(), 6u);
  EXPECT_EQ(version->bytes(), static_cast<int64_t>(pack_.size() - 6 * 4));
  EXPECT_EQ(version->labels().at("SU"), 3u);
  const auto trials = stores_->datasets->Trials(*version);
  ASSERT_EQ(trials->size(), 6u);
  for (int i = 0; i < 6; ++i) {
    const v1::TrialInfo& trial = trials->at(static_cast<size_t>(i));
    EXPECT_EQ(trial.id(), "trial-" + std::to_string(i));
    EXPECT_EQ(trial.frames(), 3u);
    EXPECT_EQ(
        trial.sha256(),
        Sha256Hex(ToRecord(testing::SmallTrial(i, 3)).SerializeAsString()));
  }
  EXPECT_EQ(*files_.Size(stores_->data->UploadPath("1")), -1);
}

TEST_F(UploadStoreTest, ResumesAtEveryBorder) {
  Random random(3);
  for (int i = 0; i < 30; ++i) {
    const std::string name = NewUpload();
    size_t done = 0;
    while (done < pack_.size()) {
      auto writer = stores_->uploads->Write(name, kCaller);
      ASSERT_TRUE(writer.ok()) << writer.status();
      EXPECT_EQ((*writer)->committed_size(), static_cast<int64_t>(done));
      // The first is every border of chunks of 64 bytes.
      const size_t size = i == 0 ? 64 : 1 + random.Index(pack_.size());
      const std::string chunk = pack_.substr(done, size);
      ASSERT_TRUE(Append(**writer, static_cast<int64_t>(done), chunk).ok());
      ASSERT_TRUE((*writer)->Commit().ok());
      done += chunk.size();
      // Not committed, and so lost.
      ASSERT_TRUE(Append(**writer, static_cast<int64_t>(done), "lost").ok());
      EXPECT_EQ((*writer)->uncommitted(), 4);
      writer->reset();
      if (i < 3) Reopen();
    }
    const auto version = stores_->Finish(name, pack_);
    ASSERT_TRUE(version.ok()) << version.status();
    EXPECT_EQ(version->trials(), 6u);
  }
  EXPECT_EQ(stores_->data->blobs().List()->size(), 7u) << "6 and a manifest";
}

TEST_F(UploadStoreTest, BadChunksChangeNothing) {
  const std::string name = NewUpload();
  auto writer = *stores_->uploads->Write(name, kCaller);
  ASSERT_TRUE(Append(*writer, 0, pack_.substr(0, 10)).ok());
  ASSERT_TRUE(writer->Commit().ok());
  for (const int64_t offset : {-1L, 0L, 9L, 11L, 1L << 62}) {
    EXPECT_EQ(ReasonOf(Append(*writer, offset, "x")), "OFFSET_MISMATCH");
  }
  EXPECT_EQ(ReasonOf(writer->Append(10, "x", 1)), "CHECKSUM_MISMATCH");
  EXPECT_EQ(ReasonOf(Append(*writer, 10, "")), "INVALID_CONFIG");
  EXPECT_EQ(ReasonOf(Append(*writer, 10,
                            std::string(limits::kMaxChunkBytes + 1, 'x'))),
            "INVALID_CONFIG");
  ASSERT_TRUE(Append(*writer, 10, pack_.substr(10)).ok());
  ASSERT_TRUE(writer->Commit().ok());
  writer.reset();
  EXPECT_TRUE(stores_->Finish(name, pack_).ok());
}

TEST_F(UploadStoreTest, HasOneWriter) {
  const std::string name = NewUpload();
  auto writer = *stores_->uploads->Write(name, kCaller);
  EXPECT_EQ(ReasonOf(stores_->uploads->Write(name, kCaller).status()),
            "UPLOAD_BUSY");
  EXPECT_EQ(ReasonOf(stores_->Finish(name, "").status()), "UPLOAD_BUSY");
  EXPECT_TRUE(stores_->uploads->Write(NewUpload(), kCaller).ok())
      << "another upload";
  writer.reset();
  EXPECT_TRUE(stores_->uploads->Write(name, kCaller).ok());
}

TEST_F(UploadStoreTest, FinishComparesSizeAndChecksum) {
  const std::string name = NewUpload();
  ASSERT_TRUE(stores_->Write(name, pack_, 1000).ok());
  EXPECT_EQ(ReasonOf(stores_->Finish(name, pack_ + "x").status()),
            "OFFSET_MISMATCH");
  std::string other = pack_;
  other[3] ^= 1;
  EXPECT_EQ(ReasonOf(stores_->Finish(name, other).status()),
            "CHECKSUM_MISMATCH");
  const auto version = stores_->Finish(name, pack_);
  ASSERT_TRUE(version.ok()) << version.status();
  // Again, with the same answer; and no more bytes.
  EXPECT_EQ(stores_->Finish(name, pack_)->name(), version->name());
  EXPECT_EQ(stores_->datasets->Get(kDataset)->latest_version(), 1u);
  EXPECT_EQ(ReasonOf(stores_->uploads->Write(name, kCaller).status()),
            "OFFSET_MISMATCH");
}

TEST_F(UploadStoreTest, ARequestIdGivesOneUpload) {
  const std::string first = NewUpload("a");
  EXPECT_EQ(NewUpload("a"), first);
  EXPECT_NE(NewUpload("b"), first);
  EXPECT_NE(NewUpload(""), NewUpload(""));
  Reopen();
  EXPECT_EQ(NewUpload("a"), first);
  for (const std::string& id :
       {std::string(129, 'a'), std::string("\xff"), std::string("a\nb")}) {
    EXPECT_EQ(
        ReasonOf(
            stores_->uploads->Create(kDataset, id, false, kCaller).status()),
        "INVALID_CONFIG");
  }
}

TEST_F(UploadStoreTest, NamesThatAreNotThere) {
  for (const char* name : {"uploads/1", "uploads/2000000000"}) {
    EXPECT_EQ(ReasonOf(stores_->uploads->Get(name).status()),
              "UPLOAD_NOT_FOUND");
    EXPECT_EQ(ReasonOf(stores_->uploads->Write(name, kCaller).status()),
              "UPLOAD_NOT_FOUND");
    EXPECT_EQ(ReasonOf(stores_->Finish(name, "").status()), "UPLOAD_NOT_FOUND");
  }
  EXPECT_EQ(ReasonOf(stores_->uploads->Write("uploads/../1", kCaller).status()),
            "INVALID_NAME");
  EXPECT_EQ(
      ReasonOf(
          stores_->uploads->Create("datasets/no", "", false, kCaller).status()),
      "DATASET_NOT_FOUND");
  // The failed calls hold nothing.
  EXPECT_TRUE(stores_->uploads->Write(NewUpload(), kCaller).ok());
}

TEST_F(UploadStoreTest, APackCutAnywhereIsRefused) {
  const std::string pack = Pack(0, 2);
  const size_t border = Pack(0, 1).size();
  for (size_t size = 0; size < pack.size(); ++size) {
    if (size == border) continue;
    const auto version = stores_->Upload(pack.substr(0, size));
    EXPECT_EQ(ReasonOf(version.status()), "INVALID_TRIAL") << size;
  }
  EXPECT_EQ(stores_->datasets->Get(kDataset)->latest_version(), 0u);
  EXPECT_TRUE(stores_->Upload(pack.substr(0, border)).ok());
}

TEST_F(UploadStoreTest, AnInvalidTrialIsNamed) {
  Trial bad = testing::SmallTrial(7);
  bad.signals[1][0] = std::nan("");
  const auto version = stores_->Upload(Pack(0, 2) + Packed(bad));
  EXPECT_EQ(ReasonOf(version.status()), "INVALID_TRIAL");
  EXPECT_THAT(std::string(version.status().message()),
              AllOf(HasSubstr("trial-7"), HasSubstr("signals")));
  const auto garbage = stores_->Upload(Pack(0, 2) + Packed("\xff\xff\xff"));
  EXPECT_THAT(std::string(garbage.status().message()),
              HasSubstr("trial number 3"));
  const std::string huge("\xff\xff\xff\xff", 4);
  EXPECT_EQ(ReasonOf(stores_->Upload(Pack(0, 1) + huge).status()),
            "INVALID_TRIAL");
  EXPECT_EQ(ReasonOf(stores_->Upload(Packed("")).status()), "INVALID_TRIAL");
  EXPECT_EQ(stores_->data->blobs().List()->size(), 0u);
}

// Blobs that existed when their trials came are gone when the upload is
// finished.
TEST_F(UploadStoreTest, BlobsMayBeDeletedDuringAnUpload) {
  ASSERT_TRUE(stores_->datasets->Create("datasets/e", "", kCaller).ok());
  ASSERT_TRUE(stores_->Upload(Pack(0, 4), false, "datasets/e").ok());
  const std::string name = NewUpload();
  ASSERT_TRUE(stores_->Write(name, pack_, 100).ok());
  ASSERT_TRUE(stores_->datasets->Delete("datasets/e", kCaller).ok());
  uint32_t known = 7;
  const auto version =
      stores_->uploads->Finish(name, static_cast<int64_t>(pack_.size()),
                               ExtendCrc32c(0, pack_), kCaller, &known);
  ASSERT_TRUE(version.ok()) << version.status();
  EXPECT_EQ(known, 0u);
  const auto trials = stores_->datasets->Trials(*version);
  ASSERT_EQ(trials->size(), 6u);
  for (const v1::TrialInfo& trial : *trials) {
    EXPECT_TRUE(
        stores_->data->blobs().Read(trial.sha256(), trial.bytes()).ok());
  }
}

// The drafts of many uploads: those of the oldest are made again.
TEST_F(UploadStoreTest, ManyUploadsWaitForTheirEnd) {
  std::vector<std::pair<std::string, std::string>> uploads;
  for (int i = 0; i < 7; ++i) {
    uploads.emplace_back(NewUpload(), Pack(10 * i, 10 * i + 3));
    ASSERT_TRUE(
        stores_->Write(uploads.back().first, uploads.back().second, 50).ok());
  }
  for (const auto& [name, pack] : uploads) {
    EXPECT_TRUE(stores_->Finish(name, pack).ok());
  }
  const auto history = stores_->datasets->GetHistory(kDataset);
  EXPECT_EQ(
      history->versions.front().trials() + history->versions.back().trials(),
      3u + 21u);
}

// Half of a chunk was written: nothing may follow it.
TEST_F(UploadStoreTest, AWriterEndsWithAnErrorOfTheDisk) {
  const std::string name = NewUpload();
  auto writer = *stores_->uploads->Write(name, kCaller);
  ASSERT_TRUE(Append(*writer, 0, pack_.substr(0, 50)).ok());
  ASSERT_TRUE(writer->Commit().ok());
  files_.FailAt(1, StorageFull("disk", "no room"));
  EXPECT_EQ(ReasonOf(Append(*writer, 50, pack_.substr(50))), "STORAGE_FULL");
  EXPECT_EQ(ReasonOf(Append(*writer, 50, pack_.substr(50))), "STORAGE_FULL");
  writer.reset();
  EXPECT_EQ(Committed(name), 50);
  writer = *stores_->uploads->Write(name, kCaller);
  ASSERT_TRUE(Append(*writer, 50, pack_.substr(50)).ok());
  files_.FailAt(1, IoError("disk", "error"));
  EXPECT_EQ(ReasonOf(writer->Commit()), "IO");
  EXPECT_EQ(ReasonOf(writer->Commit()), "IO") << "the bytes may be lost";
  EXPECT_EQ(Committed(name), 50);
  writer.reset();
  ASSERT_TRUE(stores_->Write(name, pack_, 1000).ok());
  EXPECT_TRUE(stores_->Finish(name, pack_).ok());
}

TEST_F(UploadStoreTest, LostBytesAreReported) {
  const std::string name = NewUpload();
  ASSERT_TRUE(stores_->Write(name, pack_, 1000).ok());
  ASSERT_TRUE(files_.Truncate(stores_->data->UploadPath("1"), 10).ok());
  EXPECT_EQ(ReasonOf(stores_->uploads->Write(name, kCaller).status()),
            "DATA_LOST");
  EXPECT_EQ(ReasonOf(stores_->Finish(name, pack_).status()), "DATA_LOST");
}

TEST_F(UploadStoreTest, AbandonedUploadsAreRemoved) {
  const int64_t begin = stores_->time_ms;
  const std::string left = NewUpload("r"), written = NewUpload(),
                    held = NewUpload(), finished = NewUpload();
  ASSERT_TRUE(stores_->Write(left, pack_, 1000).ok());
  ASSERT_TRUE(stores_->Write(finished, pack_, 1000).ok());
  ASSERT_TRUE(stores_->Finish(finished, pack_).ok());
  const std::string stray = stores_->data->UploadPath("77");
  ASSERT_TRUE((*files_.Append(stray))->Append("x").ok());
  stores_->time_ms = begin + limits::kAbandonedUploadMs - 1;
  EXPECT_EQ(*stores_->uploads->RemoveAbandoned(), 0);
  EXPECT_EQ(*files_.Size(stray), -1);
  ASSERT_TRUE(stores_->Write(written, pack_, 1000).ok());
  stores_->time_ms += 1;
  {
    const auto writer = stores_->uploads->Write(held, kCaller);
    EXPECT_EQ(*stores_->uploads->RemoveAbandoned(), 1);
  }
  EXPECT_EQ(ReasonOf(stores_->uploads->Get(left).status()), "UPLOAD_NOT_FOUND");
  EXPECT_EQ(*files_.Size(stores_->data->UploadPath("1")), -1);
  for (const std::string& name : {written, held, finished}) {
    EXPECT_TRUE(stores_->uploads->Get(name).ok()) << name;
  }
  EXPECT_EQ(*stores_->uploads->RemoveAbandoned(), 1) << "nobody holds it now";
  stores_->time_ms += limits::kAbandonedUploadMs;
  EXPECT_EQ(*stores_->uploads->RemoveAbandoned(), 1);
  // A request whose upload is gone begins a new one, under a new number.
  EXPECT_EQ(NewUpload("r"), "uploads/5");
}

TEST_F(UploadStoreTest, TheNumberOfARemovedUploadIsNotGivenAgain) {
  EXPECT_EQ(NewUpload(), "uploads/1");
  stores_->time_ms += limits::kAbandonedUploadMs;
  EXPECT_EQ(*stores_->uploads->RemoveAbandoned(), 1);
  EXPECT_EQ(NewUpload(), "uploads/2");
}

TEST_F(UploadStoreTest, EachClientHasItsOwnRequestIds) {
  const std::string mine = NewUpload("r");
  const auto other =
      stores_->uploads->Create(kDataset, "r", false, {"other", "unix:"});
  EXPECT_NE(other->name(), mine);
  EXPECT_EQ(NewUpload("r"), mine);
}

}  // namespace
}  // namespace tactus::internal::server
