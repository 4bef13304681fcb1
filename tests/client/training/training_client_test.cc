#include "client/training/training_client.h"

#include <future>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/training/fake_training_server.h"
#include "tests/client/training/sample_trials.h"
#include "tests/support/sealed_bundle.h"

namespace tactus::internal::client {
namespace {

using testing::FakeTrainingServer;
using ::testing::HasSubstr;

class TrainingClientTest : public ::testing::Test {
 protected:
  TrainingClientTest() : client_(server_.channel()) {}

  FakeTrainingServer server_;
  TrainingClient client_;
};

TEST_F(TrainingClientTest, ErrorsKeepTheirReason) {
  EXPECT_EQ(ReasonOf(client_.GetDataset("datasets/none").status()),
            "DATASET_NOT_FOUND");
  ASSERT_TRUE(client_.CreateDataset("datasets/arm", "first").ok());
  EXPECT_EQ(ReasonOf(client_.CreateDataset("datasets/arm", "").status()),
            "DATASET_EXISTS");
  EXPECT_EQ(ReasonOf(client_.RollbackAlias("aliases/x", "").status()),
            "ALIAS_NOT_FOUND");
}

TEST_F(TrainingClientTest, AllPagesAreRead) {
  for (const char* name : {"a", "b", "c", "d", "e"}) {
    ASSERT_TRUE(
        client_.CreateDataset(std::string("datasets/") + name, "").ok());
  }
  const auto datasets = client_.ListDatasets();
  ASSERT_TRUE(datasets.ok()) << datasets.status();
  ASSERT_EQ(datasets->size(), 5u);
  EXPECT_EQ((*datasets)[4].name(), "datasets/e");

  const auto trials = testing::SampleTrials(10);
  v1::CreateUploadRequest request;
  request.set_dataset("datasets/a");
  ASSERT_TRUE(
      TrialUploader(&client_, {}).Upload(request, testing::From(trials)).ok());
  v1::ListTrialsRequest filter;
  filter.set_dataset_version("datasets/a/versions/1");
  EXPECT_EQ(client_.ListTrials(filter)->size(), 10u);
  filter.set_label("SM");
  EXPECT_EQ(client_.ListTrials(filter)->size(), 5u);
}

TEST_F(TrainingClientTest, PagesWithoutEndAreRefused) {
  ASSERT_TRUE(client_.CreateDataset("datasets/a", "").ok());
  server_.alter = [](google::protobuf::Message& message) {
    if (auto* m = dynamic_cast<v1::ListDatasetsResponse*>(&message)) {
      m->set_next_page_token("again");
    }
  };
  EXPECT_EQ(ReasonOf(client_.ListDatasets().status()), "INVALID_RESPONSE");
}

TEST_F(TrainingClientTest, AnswersAboutOtherThingsAreRefused) {
  ASSERT_TRUE(client_.CreateDataset("datasets/a", "").ok());
  v1::Operation job;
  job.set_name("operations/3");
  server_.SetOperation(job);
  server_.alter = [](google::protobuf::Message& message) {
    if (auto* m = dynamic_cast<v1::GetDatasetResponse*>(&message)) {
      m->mutable_dataset()->set_name("datasets/b");
    }
    if (auto* m = dynamic_cast<v1::GetOperationResponse*>(&message)) {
      m->mutable_operation()->set_name("operations/4");
    }
    if (auto* m = dynamic_cast<v1::UpdateAliasResponse*>(&message)) {
      m->clear_alias();
    }
    if (auto* m = dynamic_cast<v1::TrainModelResponse*>(&message)) {
      m->clear_operation();
    }
  };
  EXPECT_EQ(ReasonOf(client_.GetDataset("datasets/a").status()),
            "INVALID_RESPONSE");
  EXPECT_EQ(ReasonOf(client_.GetOperation("operations/3").status()),
            "INVALID_RESPONSE");
  v1::UpdateAliasRequest update;
  update.set_name("aliases/default");
  EXPECT_EQ(ReasonOf(client_.UpdateAlias(update).status()), "INVALID_RESPONSE");
}

TEST_F(TrainingClientTest, BundlesTravelBothWays) {
  std::string payload(3'000'000, '\0');
  Random random(1);
  for (char& c : payload) c = static_cast<char>(random.Index(256));
  const std::string bundle = tactus::internal::testing::SealedBundle(payload);
  const auto imported = client_.ImportModel("models/arm", bundle);
  ASSERT_TRUE(imported.ok()) << imported.status();
  EXPECT_EQ(imported->name(), "models/arm/versions/1");
  const auto exported = client_.ExportModel("models/arm");
  ASSERT_TRUE(exported.ok()) << exported.status();
  EXPECT_EQ(*exported, bundle);

  server_.alter = [n = 0](google::protobuf::Message& message) mutable {
    auto* m = dynamic_cast<v1::ExportModelResponse*>(&message);
    if (m != nullptr && ++n == 5) (*m->mutable_data())[0] ^= 4;
  };
  const auto damaged = client_.ExportModel("models/arm");
  EXPECT_EQ(ReasonOf(damaged.status()), "INVALID_RESPONSE");
  EXPECT_THAT(std::string(damaged.status().message()), HasSubstr("SHA-256"));
}

TEST_F(TrainingClientTest, ASilentServerIsNotAwaitedForEver) {
  // The server may only begin the call when the client has given up.
  std::promise<void> speak;
  server_.refuse = [spoken = speak.get_future().share()](const std::string&) {
    spoken.wait();
    return grpc::Status::OK;
  };
  TrainingClient hasty(server_.channel(),
                       {.timeout = std::chrono::milliseconds(20)});
  EXPECT_EQ(ReasonOf(hasty.ListDatasets().status()), "NO_RESPONSE");
  speak.set_value();
}

}  // namespace
}  // namespace tactus::internal::client
