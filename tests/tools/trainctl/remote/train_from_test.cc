// trainctl train --from, against a server that keeps what it is asked.
#include <cstdlib>

#include "core/data/trial_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/training/fake_training_server.h"
#include "tests/client/training/sample_trials.h"
#include "tests/support/scratch_dir.h"
#include "tests/tools/trainctl/remote/trainctl_program.h"

namespace tactus::internal::client {
namespace {

using testing::FakeTrainingServer;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::Trainctl;

// A server with one version of the dataset "arm".
class TrainFromTest : public ::testing::Test {
 protected:
  TrainFromTest() : address_("unix:" + (folder_ / "s")), server_(address_) {
    setenv("TACTUS_SERVER", address_.c_str(), 1);
    const std::string path = folder_ / "arm.h5";
    auto writer = TrialFileWriter::Create(path, {.overwrite = true});
    EXPECT_TRUE(writer.ok()) << writer.status();
    for (const Trial& trial : testing::SampleTrials(5)) {
      EXPECT_TRUE(writer->Append(trial).ok());
    }
    EXPECT_TRUE(writer->Close().ok());
    EXPECT_EQ(Trainctl({"datasets", "create", "arm"}).exit, 0);
    EXPECT_EQ(Trainctl({"datasets", "upload", "arm", "--data=" + path}).exit,
              0);
  }
  ~TrainFromTest() override { unsetenv("TACTUS_SERVER"); }

  static v1::Operation Succeeded() {
    v1::Operation job;
    job.set_state(v1::Operation::STATE_SUCCEEDED);
    return job;
  }

  const ScratchDir folder_;
  const std::string address_;
  FakeTrainingServer server_;
};

TEST_F(TrainFromTest, AVersionIsTrainedAsItWas) {
  server_.SetNewJobState(Succeeded());
  v1::Operation job = Succeeded();
  job.set_name("operations/77");
  v1::PresetChoice& choice = *job.mutable_result()->mutable_preset_choice();
  choice.set_preset("ridge");
  choice.set_networks(0);
  server_.SetOperation(job);
  v1::ModelVersion version;
  version.set_name("models/arm/versions/3");
  version.set_operation("operations/77");
  version.mutable_train()->set_preset("auto");
  version.mutable_train()->set_seed(7);
  version.mutable_train()->set_choice_work(5);
  version.mutable_train()->set_dataset_version("datasets/old/versions/1");
  server_.AddModelVersion(version, "");
  Outcome outcome =
      Trainctl({"train", "--dataset=arm", "--model=arm", "--from=arm@3"});
  ASSERT_EQ(outcome.exit, 0) << outcome.err;
  const v1::TrainSpec spec = server_.last_train_spec();
  EXPECT_EQ(spec.dataset_version(), "datasets/arm/versions/1");
  EXPECT_EQ(spec.preset(), "ridge");
  EXPECT_EQ(spec.networks(), 0u);
  EXPECT_TRUE(spec.has_networks());
  EXPECT_FALSE(spec.has_choice_work());
  EXPECT_EQ(spec.seed(), 7u);

  outcome = Trainctl({"train", "--dataset=arm", "--model=arm", "--from=arm@3",
                      "--preset=paper"});
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--preset is given with --from"));
  // One that was imported says nothing of a training.
  version.set_name("models/arm/versions/4");
  version.clear_train();
  server_.AddModelVersion(version, "");
  outcome = Trainctl({"train", "--dataset=arm", "--model=arm", "--from=arm@4"});
  EXPECT_THAT(outcome.err, HasSubstr("a version that the server has trained"));
  // The job that chose has been deleted.
  version.set_name("models/arm/versions/5");
  version.set_operation("operations/78");
  version.mutable_train();
  server_.AddModelVersion(version, "");
  outcome = Trainctl({"train", "--dataset=arm", "--model=arm", "--from=arm@5"});
  EXPECT_THAT(outcome.err, HasSubstr("name a preset in the place of --from"));
}

}  // namespace
}  // namespace tactus::internal::client
