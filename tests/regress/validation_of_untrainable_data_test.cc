// `trainctl train --validate-only` said "the request is right" of a dataset
// that nothing can be trained on; the job failed later.
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/support/training_server.h"

namespace tactus::internal::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string Pack(int trials, const std::vector<std::string>& labels) {
  std::string pack;
  for (int i = 0; i < trials; ++i) {
    Trial trial = SmallTrial(i);
    trial.label = labels[i % labels.size()];
    pack += Packed(trial);
  }
  return pack;
}

std::string Validate(TrainingServer& server, const std::string& dataset,
                     bool skip_unusable = false) {
  v1::TrainModelRequest request = SmallTraining();
  request.mutable_spec()->set_dataset_version(dataset);
  request.mutable_spec()->set_skip_unusable(skip_unusable);
  request.set_validate_only(true);
  v1::TrainModelResponse response;
  grpc::ClientContext context;
  return server.training()
      .TrainModel(&context, request, &response)
      .error_message();
}

TEST(ValidationOfUntrainableDataTest, FindsIt) {
  TrainingServer server;
  server.Upload("datasets/good", SmallPack());
  EXPECT_EQ(Validate(server, "datasets/good"), "");

  server.Upload("datasets/one", Pack(6, {"a"}));
  EXPECT_THAT(Validate(server, "datasets/one"),
              AllOf(HasSubstr("datasets/one/versions/1"),
                    HasSubstr("all 6 trials are \"a\"")));

  server.Upload("datasets/single", SmallPack() + Packed([] {
                                     Trial trial = SmallTrial(20);
                                     trial.label = "c";
                                     return trial;
                                   }()));
  EXPECT_THAT(Validate(server, "datasets/single"),
              HasSubstr("class \"c\" has 1 trial;"));
  EXPECT_EQ(Validate(server, "datasets/single", true), "");

  // No more than one class is left without it.
  server.Upload("datasets/rest", Pack(3, {"a", "b", "a"}));
  EXPECT_THAT(Validate(server, "datasets/rest", true),
              HasSubstr("all 2 trials are \"a\""));
}

TEST(ValidationOfUntrainableDataTest, EvaluationsToo) {
  TrainingServer server;
  server.Upload("datasets/one", Pack(6, {"a"}));
  v1::EvaluateModelRequest request;
  request.mutable_spec()->set_dataset_version("datasets/one");
  request.mutable_spec()->set_protocol("k-fold");
  request.set_validate_only(true);
  v1::EvaluateModelResponse response;
  grpc::ClientContext context;
  EXPECT_THAT(server.training()
                  .EvaluateModel(&context, request, &response)
                  .error_message(),
              HasSubstr("all 6 trials are \"a\""));
}

}  // namespace
}  // namespace tactus::internal::testing
