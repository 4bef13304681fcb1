#include "tools/trainctl/remote/proto_json.h"

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tactus/v1/operations.pb.h"
#include "tactus/v1/training.pb.h"
#include "tests/client/training/sample_trials.h"

namespace tactus::internal::client {
namespace {

TEST(ProtoJsonTest, FieldsKeepTheirNamesAndNumbers) {
  v1::DatasetVersion version;
  version.set_name("datasets/arm/versions/2");
  version.set_bytes(9'007'199'254'740'993);
  (*version.mutable_labels())["SM"] = 2;
  (*version.mutable_labels())["HU"] = 1;
  EXPECT_EQ(JsonText(ToJson(version)),
            R"({"name":"datasets/arm/versions/2","sha256":"",)"
            R"("create_time_ms":0,"trials":0,"bytes":9007199254740993,)"
            R"("labels":{"HU":1,"SM":2},"added":0,"removed":0,)"
            R"("added_bytes":0,"requester":"","change":"unspecified",)"
            R"("reason":"","relabelled":0,"duplicates":0,"renamed":0})");
}

TEST(ProtoJsonTest, AbsentFieldsAreLeftOut) {
  v1::LearningPoint point;
  point.set_loss(-0.5);
  Json json = ToJson(point);
  EXPECT_FALSE(json.contains("accuracy"));
  EXPECT_EQ(json["loss"], -0.5);
  point.set_accuracy(0);
  json = ToJson(point);
  EXPECT_EQ(json["accuracy"], 0.0);
}

TEST(ProtoJsonTest, EnumsAndErrorsAreText) {
  v1::Operation job;
  job.set_state(v1::Operation::STATE_FAILED);
  job.mutable_train()->add_features("force");
  job.mutable_train()->set_seed(18'446'744'073'709'551'615U);
  *job.mutable_error() =
      testing::ToProto(InvalidTrial("trial 7: time: entry 2"));
  const Json json = ToJson(job);
  EXPECT_EQ(json["state"], "failed");
  EXPECT_EQ(json["kind"], "unspecified");
  EXPECT_EQ(json["train"]["features"][0], "force");
  EXPECT_EQ(json["train"]["seed"], 18'446'744'073'709'551'615U);
  EXPECT_FALSE(json.contains("evaluate"));
  EXPECT_EQ(json["error"]["reason"], "INVALID_TRIAL");
  EXPECT_EQ(json["error"]["message"], "trial 7: time: entry 2");
  EXPECT_EQ(json["error"]["code"], 3);
}

}  // namespace
}  // namespace tactus::internal::client
