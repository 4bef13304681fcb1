// The contact log over gRPC: from a robot's stream to a list, a replay and a
// labelled trial.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/base/errors.h"
#include "core/data/trial_record.h"
#include "gtest/gtest.h"
#include "tests/server/support/keeping_server.h"
#include "tests/server/support/test_server.h"
#include "tests/server/support/training_server.h"

namespace tactus::internal {
namespace {

using testing::KeepingServer;
using testing::TrainingServer;

constexpr int kFrames = KeepingServer::kFrames;

TEST(ContactLogRpcTest, ListsWhatWasAnswered) {
  KeepingServer keeping;
  const auto finals = keeping.Stream("left-arm", {1, 2, 3});
  ASSERT_EQ(finals.size(), 3u);
  v1::ListContactsRequest request;
  request.set_with_pictures(true);
  const v1::ListContactsResponse response = keeping.List(request);
  ASSERT_EQ(response.contacts_size(), 3);
  EXPECT_EQ(response.matching(), 3u);
  EXPECT_EQ(response.left_out(), 0u);
  EXPECT_GT(response.bytes(), 0);
  // The newest first.
  for (int i = 0; i < 3; ++i) {
    const v1::LoggedContact& contact = response.contacts(2 - i);
    const v1::Contact& last = finals[i].contacts(0);
    const auto best =
        std::max_element(last.probability().begin(), last.probability().end());
    EXPECT_EQ(contact.robot(), "left-arm");
    EXPECT_EQ(contact.model_version(), "models/default/versions/1");
    EXPECT_EQ(contact.onset_sequence(), last.onset_sequence());
    EXPECT_EQ(contact.end_sequence(), finals[i].sequence());
    EXPECT_EQ(contact.confidence(), *best);
    EXPECT_EQ(contact.unknown(), last.unknown());
    EXPECT_EQ(contact.duration_ns(), last.time_since_onset_ns());
    EXPECT_EQ(contact.answers_size(), last.answers_size());
    EXPECT_TRUE(contact.exact());
    EXPECT_FALSE(contact.cut());
    EXPECT_EQ(contact.picture().loads().size(), 16u * 24);
    EXPECT_GT(contact.max_force(), 0);
    EXPECT_EQ(contact.picture().most(), contact.max_force());
  }
}

TEST(ContactLogRpcTest, AReplayHasTheSameBits) {
  KeepingServer keeping;
  const auto finals = keeping.Stream("arm", {7, 8});
  const v1::ListContactsResponse list = keeping.List({});
  ASSERT_EQ(list.contacts_size(), 2);
  for (int i = 0; i < 2; ++i) {
    const auto replay = keeping.Replay(list.contacts(1 - i).name());
    EXPECT_TRUE(replay.same_answers());
    EXPECT_EQ(replay.started().class_names_size(), 4);
    EXPECT_EQ(replay.replayed().label(), replay.contact().label());
    EXPECT_EQ(replay.frames_size(), kFrames);
    ASSERT_EQ(replay.contact_id(), 1u);
    const v1::Answer& last = replay.frames(kFrames - 1).answer();
    ASSERT_EQ(last.contacts_size(), 1);
    EXPECT_EQ(last.contacts(0).probability_size(),
              finals[i].contacts(0).probability_size());
    for (int c = 0; c < last.contacts(0).probability_size(); ++c) {
      EXPECT_EQ(last.contacts(0).probability(c),
                finals[i].contacts(0).probability(c));
    }
  }
}

TEST(ContactLogRpcTest, ALabelMakesATrial) {
  KeepingServer keeping;
  keeping.Stream("arm", {1, 2});
  const v1::ListContactsResponse list = keeping.List({});
  const v1::LoggedContact& contact = list.contacts(1);
  keeping.CreateDataset("datasets/corrected");
  const auto version =
      keeping.Label("datasets/corrected", {{contact.name(), "SM"}}, "once");
  ASSERT_TRUE(version.ok()) << version.status();
  EXPECT_EQ(version->name(), "datasets/corrected/versions/1");
  EXPECT_EQ(version->change(), v1::DatasetVersion::CHANGE_CONTACTS);
  EXPECT_EQ(version->labels().at("SM"), 1u);
  // A second try of the same request.
  const auto again =
      keeping.Label("datasets/corrected", {{contact.name(), "SM"}}, "once");
  EXPECT_EQ(again->name(), version->name());

  const auto trials = keeping.Trials(version->name());
  ASSERT_EQ(trials.size(), 1u);
  EXPECT_EQ(trials[0].label(), "SM");
  EXPECT_EQ(trials[0].frames(), static_cast<uint32_t>(kFrames));
  const v1::Labelling& labelling = trials[0].labelling();
  EXPECT_FALSE(labelling.by().empty());
  EXPECT_EQ(labelling.before(), contact.label());
  EXPECT_EQ(labelling.confidence(), contact.confidence());
  EXPECT_EQ(labelling.model_version(), contact.model_version());

  v1::ListContactsRequest request;
  request.set_labelled(true);
  const v1::ListContactsResponse labelled = keeping.List(request);
  ASSERT_EQ(labelled.contacts_size(), 1);
  EXPECT_EQ(labelled.contacts(0).given().label(), "SM");
  EXPECT_EQ(labelled.contacts(0).given().dataset_version(), version->name());
}

TEST(ContactLogRpcTest, AnotherLabelTakesThePlaceOfTheFirst) {
  KeepingServer keeping;
  keeping.Stream("arm", {1, 2});
  const std::string name = keeping.List({}).contacts(0).name();
  const std::string other = keeping.List({}).contacts(1).name();
  keeping.CreateDataset("datasets/corrected");
  ASSERT_TRUE(keeping.Label("datasets/corrected", {{name, "SM"}}).ok());
  const auto version =
      keeping.Label("datasets/corrected", {{name, "HU"}, {other, "HM"}});
  ASSERT_TRUE(version.ok()) << version.status();
  EXPECT_EQ(version->trials(), 2u);
  EXPECT_EQ(version->relabelled(), 1u);
  EXPECT_EQ(version->labels().count("SM"), 0u);
}

TEST(ContactLogRpcTest, NothingChangesAfterAnError) {
  KeepingServer keeping;
  keeping.Stream("arm", {1});
  const std::string name = keeping.List({}).contacts(0).name();
  const auto reason =
      [&](const std::string& dataset,
          const std::vector<std::pair<std::string, std::string>>& labels) {
        return ReasonOf(keeping.Label(dataset, labels).status());
      };
  EXPECT_EQ(reason("datasets/none", {{name, "SM"}}), "DATASET_NOT_FOUND");
  keeping.CreateDataset("datasets/d");
  EXPECT_EQ(reason("datasets/d", {}), "INVALID_CONFIG");
  EXPECT_EQ(reason("datasets/d", {{name, ""}}), "INVALID_CONFIG");
  EXPECT_EQ(reason("datasets/d", {{name, std::string(257, 'x')}}),
            "INVALID_CONFIG");
  EXPECT_EQ(reason("datasets/d", {{name, "SM"}, {name, "SU"}}),
            "INVALID_CONFIG");
  EXPECT_EQ(reason("datasets/d", {{"contacts/x", "SM"}}), "INVALID_NAME");
  EXPECT_EQ(reason("datasets/d", {{name, "SM"}, {"contacts/999", "SM"}}),
            "CONTACT_NOT_FOUND");
  EXPECT_EQ(reason("datasets/d", {{name + "-2", "SM"}}), "CONTACT_NOT_FOUND");
  v1::GetDatasetRequest request;
  request.set_name("datasets/d");
  v1::GetDatasetResponse response;
  grpc::ClientContext context;
  ASSERT_TRUE(keeping.server()
                  .training()
                  .GetDataset(&context, request, &response)
                  .ok());
  EXPECT_EQ(response.dataset().latest_version(), 0u);
  EXPECT_FALSE(keeping.List({}).contacts(0).has_given());
}

TEST(ContactLogRpcTest, AServerWithoutALogSaysSo) {
  testing::TestServer server;
  const auto stub = v1::ContactLogService::NewStub(server.channel());
  grpc::ClientContext context;
  v1::ListContactsResponse response;
  const auto status = stub->ListContacts(&context, {}, &response);
  EXPECT_EQ(ReasonOf(client::FromGrpcStatus(status)), "NO_CONTACT_LOG");
}

TEST(ContactLogRpcTest, OnlyAServerSaysWhoLabelled) {
  TrainingServer server;
  v1::TrialRecord record = ToRecord(testing::SmallTrial(0));
  record.mutable_labelling()->set_by("somebody else");
  const std::string pack = testing::Packed(record.SerializeAsString());
  EXPECT_NE(server.Upload("datasets/forged", pack).find("labelling"),
            std::string::npos);
}

}  // namespace
}  // namespace tactus::internal
