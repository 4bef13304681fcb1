#include "client/training/trial_downloader.h"

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/training/fake_training_server.h"
#include "tests/client/training/sample_trials.h"

namespace tactus::internal::client {
namespace {

using testing::FakeTrainingServer;

constexpr char kVersion[] = "datasets/arm/versions/1";

class TrialDownloaderTest : public ::testing::Test {
 protected:
  TrialDownloaderTest() : client_(server_.channel()) {
    EXPECT_TRUE(client_.CreateDataset("datasets/arm", "").ok());
    v1::CreateUploadRequest request;
    request.set_dataset("datasets/arm");
    EXPECT_TRUE(TrialUploader(&client_, {})
                    .Upload(request, testing::From(trials_))
                    .ok());
    server_.download_bytes = 100;
    options_.retry = testing::NoWaits();
  }

  absl::StatusOr<DownloadTotals> Download() {
    received_.clear();
    return DownloadTrials(
        client_, kVersion,
        [&](const Trial& trial) {
          received_.push_back(ToRecord(trial).SerializeAsString());
          return absl::OkStatus();
        },
        options_);
  }

  void ExpectAll() {
    ASSERT_EQ(received_.size(), trials_.size());
    for (size_t i = 0; i < trials_.size(); ++i) {
      EXPECT_EQ(received_[i], ToRecord(trials_[i]).SerializeAsString());
    }
  }

  const std::vector<Trial> trials_ = testing::SampleTrials(6);
  FakeTrainingServer server_;
  TrainingClient client_;
  DownloadOptions options_;
  std::vector<std::string> received_;
};

TEST_F(TrialDownloaderTest, EveryTrialArrives) {
  const auto totals = Download();
  ASSERT_TRUE(totals.ok()) << totals.status();
  ExpectAll();
  EXPECT_EQ(totals->trials, 6u);
  EXPECT_EQ(totals->bytes,
            static_cast<int64_t>(testing::PackOf(trials_).size()));
}

TEST_F(TrialDownloaderTest, AnInterruptionAtEveryMessageIsSurvived) {
  const auto size = static_cast<int64_t>(testing::PackOf(trials_).size());
  for (int64_t at = 0; at < size; at += 100) {
    server_.BreakDownloadAt(at);
    const auto totals = Download();
    ASSERT_TRUE(totals.ok()) << totals.status();
    EXPECT_EQ(totals->bytes, size);
    ExpectAll();
  }
}

TEST_F(TrialDownloaderTest, ARepetitionThatDiffersIsRefused) {
  server_.BreakDownloadAt(300);
  // The server outlives this function, and may still send.
  server_.alter = [messages = 0](google::protobuf::Message& message) mutable {
    auto* m = dynamic_cast<v1::DownloadTrialsResponse*>(&message);
    if (m != nullptr && ++messages == 4) (*m->mutable_data())[50] ^= 1;
  };
  EXPECT_EQ(ReasonOf(Download().status()), "INVALID_RESPONSE");
}

TEST_F(TrialDownloaderTest, AShortPackIsRefused) {
  server_.alter = [](google::protobuf::Message& message) {
    if (auto* m = dynamic_cast<v1::DownloadTrialsResponse*>(&message)) {
      if (m->data().size() < 100) m->mutable_data()->pop_back();
    }
  };
  EXPECT_EQ(ReasonOf(Download().status()), "INVALID_RESPONSE");
}

TEST_F(TrialDownloaderTest, TheErrorOfTheSinkEndsIt) {
  const auto totals = DownloadTrials(
      client_, kVersion,
      [](const Trial&) { return absl::UnavailableError("disk"); }, options_);
  EXPECT_EQ(totals.status().message(), "disk");
}

}  // namespace
}  // namespace tactus::internal::client
