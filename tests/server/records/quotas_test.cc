#include "server/records/quotas.h"

#include <atomic>
#include <thread>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/records/stores.h"

namespace tactus::internal::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const Caller kOther = {"other", "unix:"};

class QuotasTest : public ::testing::Test {
 protected:
  void Open(const Quotas& quotas) {
    stores_ = std::make_unique<Stores>(&PosixFileSystem(), folder_ / "data", "",
                                       quotas);
  }
  std::string Create(const char* dataset, const Caller& caller = kCaller) {
    return ReasonOf(stores_->datasets->Create(dataset, "", caller).status());
  }
  int64_t Use(const Caller& caller = kCaller) {
    int64_t bytes = -1;
    EXPECT_TRUE(stores_->data->catalog()
                    .Look([&](const Transaction& look) -> absl::Status {
                      TACTUS_ASSIGN_OR_RETURN(bytes,
                                              StoredBytes(look, caller.name));
                      return absl::OkStatus();
                    })
                    .ok());
    return bytes;
  }

  ScratchDir folder_;
  std::unique_ptr<Stores> stores_;
  const std::string pack_ = Pack(0, 4);
  const int64_t size_ = static_cast<int64_t>(pack_.size());
};

TEST_F(QuotasTest, DatasetsOfAClientAreBounded) {
  Open({.datasets = 2});
  EXPECT_EQ(Create("datasets/a"), "");
  EXPECT_EQ(Create("datasets/b"), "");
  const auto refused = stores_->datasets->Create("datasets/c", "", kCaller);
  EXPECT_EQ(ReasonOf(refused.status()), "QUOTA_EXCEEDED");
  EXPECT_THAT(std::string(refused.status().message()),
              AllOf(HasSubstr("datasets of tester is 2"),
                    HasSubstr("2 are in use"), HasSubstr("delete")));
  EXPECT_EQ(Create("datasets/c", kOther), "");
  EXPECT_EQ(Create("datasets/a"), "DATASET_EXISTS");
  ASSERT_TRUE(stores_->datasets->Delete("datasets/a", kOther).ok());
  EXPECT_EQ(Create("datasets/d"), "");
}

TEST_F(QuotasTest, UnfinishedUploadsOfAClientAreBounded) {
  Open({.open_uploads = 2});
  EXPECT_EQ(Create(kDataset), "");
  const auto begin = [&](const Caller& caller) {
    return stores_->uploads->Create(kDataset, "", false, caller);
  };
  const auto first = begin(kCaller);
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_TRUE(begin(kCaller).ok());
  const auto refused = begin(kCaller);
  EXPECT_EQ(ReasonOf(refused.status()), "QUOTA_EXCEEDED");
  EXPECT_THAT(std::string(refused.status().message()),
              AllOf(HasSubstr("unfinished uploads of tester is 2"),
                    HasSubstr("finish those that wait")));
  EXPECT_TRUE(begin(kOther).ok());
  EXPECT_TRUE(stores_->Write(first->name(), pack_, pack_.size()).ok());
  EXPECT_TRUE(stores_->Finish(first->name(), pack_).ok());
  EXPECT_TRUE(begin(kCaller).ok());
}

TEST_F(QuotasTest, QueuedJobsOfAClientAreBounded) {
  Open({.queued_jobs = 1});
  const auto create = [&](const Caller& caller, const char* id = "") {
    return stores_->operations->Create({}, id, caller);
  };
  const auto job = create(kCaller, "r");
  EXPECT_EQ(ReasonOf(create(kCaller).status()), "QUOTA_EXCEEDED");
  EXPECT_TRUE(create(kOther).ok());
  EXPECT_EQ(create(kCaller, "r")->name(), job->name()) << "no new one";
  ASSERT_TRUE(stores_->operations
                  ->Change(job->name(),
                           [](v1::Operation& operation) {
                             operation.set_state(v1::Operation::STATE_RUNNING);
                             return absl::OkStatus();
                           })
                  .ok());
  EXPECT_TRUE(create(kCaller).ok());
}

TEST_F(QuotasTest, ModelBytesCountUntilTheVersionIsDeleted) {
  const std::string bundle = TestBundle(1);
  const auto size = static_cast<int64_t>(bundle.size());
  Open({.model_bytes = 2 * size - 1});
  const auto add = [&](const Caller& caller) {
    return stores_->models->AddVersion("models/m", bundle, {}, caller);
  };
  const auto first = add(kCaller);
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_EQ(first->requester(), kCaller.name);
  EXPECT_EQ(ReasonOf(add(kCaller).status()), "QUOTA_EXCEEDED");
  EXPECT_TRUE(add(kOther).ok());
  ASSERT_TRUE(stores_->models->Delete(first->name(), kCaller).ok());
  EXPECT_TRUE(add(kCaller).ok());
}

TEST_F(QuotasTest, StoredBytesCountFromTheUploadToTheDeletion) {
  Open({.stored_bytes = 2 * size_});
  ASSERT_EQ(Create(kDataset), "");
  const auto version = stores_->Upload(pack_);
  ASSERT_TRUE(version.ok()) << version.status();
  EXPECT_EQ(Use(), size_ - 4 * 4) << "without the lengths";
  // Trials that the dataset has already cost nothing.
  ASSERT_TRUE(stores_->Upload(pack_).ok());
  EXPECT_EQ(Use(), size_ - 4 * 4);
  // An upload counts before it is finished, and for who made it.
  const auto upload = stores_->uploads->Create(kDataset, "", false, kCaller);
  ASSERT_TRUE(stores_->Write(upload->name(), pack_, 1 << 20).ok());
  EXPECT_EQ(Use(), 2 * size_ - 4 * 4);
  EXPECT_EQ(Use(kOther), 0);
  const auto more = stores_->uploads->Create(kDataset, "", false, kCaller);
  ASSERT_TRUE(more.ok()) << "16 bytes are left";
  const absl::Status refused = stores_->Write(more->name(), pack_, 1 << 20);
  EXPECT_EQ(ReasonOf(refused), "QUOTA_EXCEEDED");
  EXPECT_THAT(std::string(refused.message()),
              HasSubstr("stored bytes of tester is"));
  EXPECT_EQ(stores_->uploads->Get(more->name())->committed_size(), 0);
  EXPECT_EQ(*PosixFileSystem().Size(stores_->data->UploadPath("4")), 0)
      << "what does not count is not on disk";
  // Others are not affected.
  EXPECT_TRUE(stores_->uploads->Create(kDataset, "", false, kOther).ok());
  // What fits exactly is taken; then no upload begins.
  ASSERT_TRUE(stores_->Write(more->name(), pack_.substr(0, 16), 16).ok());
  EXPECT_EQ(
      ReasonOf(stores_->uploads->Create(kDataset, "", false, kCaller).status()),
      "QUOTA_EXCEEDED");
  // Deletion frees.
  ASSERT_TRUE(stores_->datasets->Delete(kDataset, kOther).ok());
  EXPECT_EQ(Use(), size_ + 16);
}

TEST_F(QuotasTest, TwoWritersDoNotPassTogether) {
  constexpr int kWriters = 6;
  // Room for two of them.
  Open({.stored_bytes = 2 * size_ + size_ / 2});
  ASSERT_EQ(Create(kDataset), "");
  std::vector<std::string> uploads;
  for (int i = 0; i < kWriters; ++i) {
    uploads.push_back(
        stores_->uploads->Create(kDataset, "", false, kCaller)->name());
  }
  std::atomic<int> taken = 0;
  std::vector<std::thread> threads;
  for (const std::string& name : uploads) {
    threads.emplace_back([&, name] {
      taken += stores_->Write(name, pack_, 1 << 20).ok() ? 1 : 0;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(taken, 2);
  EXPECT_EQ(Use(), 2 * size_);
}

}  // namespace
}  // namespace tactus::internal::server
