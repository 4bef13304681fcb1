// trainctl's commands that speak to a server, from the command line to the exit
// code.
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include "core/base/errors.h"
#include "core/bundle/bundle.h"
#include "core/data/trial_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/training/fake_training_server.h"
#include "tests/client/training/sample_trials.h"
#include "tests/server/support/tls_files.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/sealed_bundle.h"
#include "tests/tools/trainctl/remote/trainctl_program.h"
#include "tools/common/json.h"
#include "tools/trainctl/remote/flags.h"

namespace tactus::internal::client {
namespace {

using ::testing::AllOf;
using testing::FakeTrainingServer;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::Outcome;
using testing::SampleTrials;
using testing::Trainctl;

std::string ReadText(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

class TrainctlRemoteTest : public ::testing::Test {
 protected:
  TrainctlRemoteTest()
      : folder_(std::filesystem::temp_directory_path() /
                ("tactus-remote-" + std::to_string(getpid()))),
        address_("unix:" + (folder_ / "s").string()) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    server_ = std::make_unique<FakeTrainingServer>(address_);
    setenv("TACTUS_SERVER", address_.c_str(), 1);
  }
  ~TrainctlRemoteTest() override {
    unsetenv("TACTUS_SERVER");
    std::filesystem::remove_all(folder_);
  }

  std::string Path(const std::string& name) const { return folder_ / name; }

  std::string WriteTrials(const std::string& name,
                          const std::vector<Trial>& trials) {
    auto writer = TrialFileWriter::Create(Path(name), {.overwrite = true});
    EXPECT_TRUE(writer.ok()) << writer.status();
    for (const Trial& trial : trials) {
      EXPECT_TRUE(writer->Append(trial).ok());
    }
    EXPECT_TRUE(writer->Close().ok());
    return Path(name);
  }

  // The dataset "arm" with one version.
  void MakeDataset() {
    ASSERT_EQ(Trainctl({"datasets", "create", "arm"}).exit, 0);
    ASSERT_EQ(Trainctl({"datasets", "upload", "arm",
                        "--data=" + WriteTrials("arm.h5", SampleTrials(5))})
                  .exit,
              0);
  }

  v1::Operation Job(v1::Operation::State state) {
    v1::Operation job;
    job.set_state(state);
    return job;
  }

  static v1::Operation Failed(const absl::Status& error) {
    v1::Operation job;
    job.set_state(v1::Operation::STATE_FAILED);
    *job.mutable_error() = testing::ToProto(error);
    return job;
  }

  const std::filesystem::path folder_;
  const std::string address_;
  std::unique_ptr<FakeTrainingServer> server_;
};

TEST_F(TrainctlRemoteTest, DatasetsGoThereAndBack) {
  const auto trials = SampleTrials(5);
  const std::string file = WriteTrials("arm.h5", trials);
  Outcome outcome =
      Trainctl({"datasets", "create", "arm", "--description=left arm"});
  ASSERT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "datasets/arm\n");
  outcome = Trainctl({"datasets", "upload", "arm", "--data=" + file});
  ASSERT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("datasets/arm/versions/1"), HasSubstr("5 trials"),
                    HasSubstr("HU 3, SM 2")));
  EXPECT_EQ(server_->PackOf("datasets/arm"), testing::PackOf(trials));

  outcome = Trainctl({"datasets", "list", "--json"});
  EXPECT_EQ(outcome.json()[0]["latest_version"], 1);
  outcome = Trainctl({"datasets", "show", "arm@1", "--json"});
  EXPECT_EQ(outcome.json()["labels"]["HU"], 3);
  outcome = Trainctl({"datasets", "show", "arm", "--label=SM", "--json"});
  EXPECT_EQ(outcome.json()["trials"].size(), 2u);
  EXPECT_THAT(Trainctl({"datasets", "show", "arm"}).out, HasSubstr("left arm"));

  outcome = Trainctl({"datasets", "download", "arm", "--out=" + Path("b.h5")});
  ASSERT_EQ(outcome.exit, 0) << outcome.err;
  auto reader = TrialFileReader::Open(Path("b.h5"));
  ASSERT_TRUE(reader.ok()) << reader.status();
  const auto back = reader->ReadAll();
  ASSERT_EQ(back->size(), 5u);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(ToRecord((*back)[i]).SerializeAsString(),
              ToRecord(trials[i]).SerializeAsString());
  }

  auto changed = trials;
  changed[1].label = "HM";
  changed.pop_back();
  outcome = Trainctl({"datasets", "upload", "arm", "--replace",
                      "--data=" + WriteTrials("arm.h5", changed)});
  ASSERT_EQ(outcome.exit, 0) << outcome.err;
  outcome = Trainctl({"datasets", "diff", "arm@1", "arm@2"});
  EXPECT_EQ(
      outcome.out,
      "- 101  SM\n- 104  HU\n+ 101  HM\n2 removed, 1 added, 3 the same\n");
  outcome = Trainctl({"datasets", "diff", "arm@1", "arm@2", "--json"});
  EXPECT_EQ(outcome.json()["same"], 3);
  EXPECT_EQ(outcome.json()["removed"].size(), 2u);

  outcome = Trainctl({"datasets", "delete", "arm"});
  EXPECT_EQ(outcome.exit, 0) << outcome.err;
  outcome = Trainctl({"datasets", "show", "arm"});
  EXPECT_EQ(outcome.exit, 1);
  EXPECT_THAT(outcome.err, HasSubstr("[DATASET_NOT_FOUND]"));
}

TEST_F(TrainctlRemoteTest, AnInterruptedUploadContinuesInTheNextProgram) {
  ASSERT_EQ(Trainctl({"datasets", "create", "arm"}).exit, 0);
  const auto trials = SampleTrials(5);
  const std::string file = WriteTrials("arm.h5", trials);
  // The first program sends everything and ends before it finishes.
  server_->refuse = [](const std::string& method) {
    return method == "FinishUpload"
               ? grpc::Status(grpc::StatusCode::DATA_LOSS, "stop")
               : grpc::Status::OK;
  };
  EXPECT_EQ(Trainctl({"datasets", "upload", "arm", "--data=" + file}).exit, 1);
  const int64_t sent = server_->bytes_received();
  EXPECT_EQ(sent, static_cast<int64_t>(testing::PackOf(trials).size()));
  server_->refuse = nullptr;
  EXPECT_EQ(Trainctl({"datasets", "upload", "arm", "--data=" + file}).exit, 0);
  EXPECT_EQ(server_->bytes_received(), sent);
  // The dataset has changed, so this is another upload.
  EXPECT_EQ(Trainctl({"datasets", "upload", "arm", "--data=" + file}).exit, 0);
  EXPECT_EQ(server_->bytes_received(), 2 * sent);
}

TEST_F(TrainctlRemoteTest, ASkinThatTheServerCannotKnowIsFoundBeforeTheUpload) {
  ASSERT_EQ(Trainctl({"datasets", "create", "arm"}).exit, 0);
  auto trials = SampleTrials(2);
  trials[1].layout = "palm";
  trials[1].taxels.rows = trials[1].taxels.columns = 1;
  trials[1].taxels.u16.assign(trials[1].time.size(), 1);
  const Outcome outcome = Trainctl(
      {"datasets", "upload", "arm", "--data=" + WriteTrials("a.h5", trials)});
  EXPECT_EQ(outcome.exit, 1);
  EXPECT_THAT(outcome.err, HasSubstr("[UNKNOWN_LAYOUT]"));
  EXPECT_EQ(server_->bytes_received(), 0);
}

TEST_F(TrainctlRemoteTest, ASkinThatIsNoPresetIsSent) {
  ASSERT_EQ(Trainctl({"datasets", "create", "arm"}).exit, 0);
  auto trials = SampleTrials(2);
  SkinLayout palm = *LayoutPreset("icub-6x10");
  palm.name = "palm";
  palm.rows = palm.columns = 1;
  trials[1].taxels.rows = trials[1].taxels.columns = 1;
  trials[1].taxels.u16.assign(trials[1].time.size(), 1);
  SetSkin(palm, trials[1]);
  Outcome outcome = Trainctl(
      {"datasets", "upload", "arm", "--data=" + WriteTrials("a.h5", trials)});
  ASSERT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_EQ(server_->PackOf("datasets/arm"), testing::PackOf(trials));
  outcome = Trainctl({"datasets", "download", "arm", "--out=" + Path("b.h5")});
  ASSERT_EQ(outcome.exit, 0) << outcome.err;
  auto reader = TrialFileReader::Open(Path("b.h5"));
  ASSERT_TRUE(reader.ok()) << reader.status();
  EXPECT_EQ((*reader->ReadAll())[1].skin, palm);
}

TEST_F(TrainctlRemoteTest, TrainWatchesTheJobToItsEnd) {
  MakeDataset();
  server_->SetNewJobState(Job(v1::Operation::STATE_RUNNING));
  std::thread job([&] {
    server_->AwaitWatchers(1);
    v1::LearningPoint point;
    point.set_phase("train LSTMs");
    point.set_part("1");
    point.set_max_iterations(2);
    for (uint32_t i = 1; i <= 2; ++i) {
      point.set_iteration(i);
      point.set_loss(1.0 / i);
      server_->AddPoint("operations/1", point);
    }
    v1::Operation ended = server_->operation("operations/1");
    ended.set_state(v1::Operation::STATE_SUCCEEDED);
    ended.mutable_result()->set_model_version("models/arm/versions/1");
    ended.mutable_result()->add_unusable_trials("104");
    ended.mutable_result()->set_unusable(3000);
    server_->SetOperation(ended);
  });
  const Outcome outcome =
      Trainctl({"train", "--dataset=arm", "--model=arm", "--preset=paper",
                "--features=f,m", "--seed=7", "--networks=0", "--epochs=3",
                "--hmms-per-class=2", "--skip-unusable", "--note=first",
                "--truth=so-far", "--shares=even",
                "--with-cues=force_pitch_short,force_pitch_long",
                "--without-cues=log_drag"});
  job.join();
  EXPECT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_THAT(
      outcome.out,
      AllOf(HasSubstr("models/arm/versions/1"),
            HasSubstr("3,000 unusable trials were left out: 104, ...")));
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr("trainctl: operations/1 running\n"),
                    HasSubstr("train LSTMs 1, iteration 2 of 2: loss 0.5\n"),
                    HasSubstr("operations/1 succeeded\n")));
  const v1::TrainSpec spec = server_->last_train_spec();
  EXPECT_EQ(spec.dataset_version(), "datasets/arm/versions/1");
  EXPECT_EQ(spec.model(), "models/arm");
  EXPECT_EQ(spec.preset(), "paper");
  EXPECT_THAT(spec.features(), ::testing::ElementsAre("force", "motion"));
  EXPECT_EQ(spec.seed(), 7u);
  EXPECT_TRUE(spec.has_networks());
  EXPECT_EQ(spec.networks(), 0u);
  EXPECT_EQ(spec.epochs(), 3u);
  EXPECT_EQ(spec.hmms_per_class(), 2u);
  EXPECT_TRUE(spec.skip_unusable());
  EXPECT_EQ(spec.note(), "first");
  EXPECT_EQ(spec.truth(), v1::TRUTH_SO_FAR);
  EXPECT_EQ(spec.shares(), v1::CLASS_SHARES_EVEN);
  EXPECT_THAT(spec.with_cues(),
              ::testing::ElementsAre("force_pitch_short", "force_pitch_long"));
  EXPECT_THAT(spec.without_cues(), ::testing::ElementsAre("log_drag"));
}

TEST_F(TrainctlRemoteTest, WordsThatNoServerKnowsAreWrongUsage) {
  MakeDataset();
  for (const char* flag : {"--truth=soon", "--shares=fair"}) {
    const Outcome outcome =
        Trainctl({"train", "--dataset=arm", "--model=arm", flag});
    EXPECT_EQ(outcome.exit, 2) << flag;
    EXPECT_THAT(outcome.err, HasSubstr(std::string(flag).substr(0, 6)));
  }
}

TEST_F(TrainctlRemoteTest, DetachReturnsAtOnce) {
  MakeDataset();
  const Outcome outcome = Trainctl(
      {"train", "--dataset=arm@1", "--model=arm", "--detach", "--json"});
  ASSERT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["state"], "queued");
  EXPECT_EQ(outcome.json()["name"], "operations/1");
  EXPECT_FALSE(server_->last_train_spec().has_networks());
}

TEST_F(TrainctlRemoteTest, ExitCodesSayHowAJobEnded) {
  MakeDataset();
  const std::vector<std::string> train = {"train", "--dataset=arm",
                                          "--model=arm", "--json"};
  server_->SetNewJobState(Failed(InvalidTrainingData("too few trials")));
  Outcome outcome = Trainctl(train);
  EXPECT_EQ(outcome.exit, 3);
  EXPECT_EQ(outcome.json()["error"]["reason"], "INVALID_TRAINING_DATA");
  EXPECT_THAT(outcome.err, HasSubstr("operations/1 failed: too few trials "
                                     "[INVALID_TRAINING_DATA]"));
  server_->SetNewJobState(Job(v1::Operation::STATE_CANCELLED));
  EXPECT_EQ(Trainctl(train).exit, 4);
  EXPECT_EQ(Trainctl({"jobs", "watch", "1"}).exit, 3);
  EXPECT_EQ(Trainctl({"jobs", "watch", "operations/2"}).exit, 4);
  EXPECT_EQ(Trainctl({"jobs", "watch", "9"}).exit, 1);
  // To show a failed job is no failure.
  EXPECT_EQ(Trainctl({"jobs", "show", "1"}).exit, 0);
}

TEST_F(TrainctlRemoteTest, CtrlCEndsTheWatchAndNotTheJob) {
  MakeDataset();
  server_->SetNewJobState(Job(v1::Operation::STATE_RUNNING));
  std::thread user([&] {
    server_->AwaitWatchers(1);
    kill(getpid(), SIGINT);
  });
  const Outcome outcome = Trainctl({"train", "--dataset=arm", "--model=arm"});
  user.join();
  EXPECT_EQ(outcome.exit, 130);
  EXPECT_THAT(outcome.err, HasSubstr("The job goes on; watch it with: trainctl "
                                     "jobs watch 1 --server=" +
                                     address_));
  EXPECT_EQ(server_->operation("operations/1").state(),
            v1::Operation::STATE_RUNNING);
}

TEST_F(TrainctlRemoteTest, EvaluateRunsOnTheServerThatHasTheDataset) {
  MakeDataset();
  v1::ModelVersion version;
  version.set_name("models/arm/versions/2");
  server_->AddModelVersion(version, "");
  v1::Operation job = Job(v1::Operation::STATE_SUCCEEDED);
  v1::EvaluationReport& report = *job.mutable_result()->mutable_evaluation();
  report.mutable_accuracy()->set_correct(3);
  report.mutable_accuracy()->set_contacts(4);
  for (const char* name : {"HU", "SM"}) report.add_class_names(name);
  for (const uint32_t count : {2, 1, 0, 1}) report.add_confusion(count);
  server_->SetNewJobState(job);
  Outcome outcome = Trainctl({"evaluate", "--dataset=arm", "--model=arm@2"});
  ASSERT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("accuracy 75.00 %"),
                                 HasSubstr("HU        2        1\n"),
                                 HasSubstr("SM        0        1\n")));
  v1::EvaluateSpec spec = server_->operation("operations/1").evaluate();
  EXPECT_EQ(spec.dataset_version(), "datasets/arm/versions/1");
  EXPECT_EQ(spec.model_version(), "models/arm/versions/2");
  EXPECT_FALSE(spec.has_train());

  outcome = Trainctl({"evaluate", "--dataset=arm@1",
                      "--protocol=leave-one-material-out", "--preset=paper",
                      "--hmms-per-class=2", "--truth=so-far",
                      "--without-cues=log_drag", "--detach", "--json"});
  ASSERT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["evaluate"]["protocol"], "leave-one-material-out");
  spec = server_->operation("operations/2").evaluate();
  EXPECT_EQ(spec.train().preset(), "paper");
  EXPECT_EQ(spec.train().hmms_per_class(), 2u);
  EXPECT_EQ(spec.train().truth(), v1::TRUTH_SO_FAR);
  EXPECT_THAT(spec.train().without_cues(), ::testing::ElementsAre("log_drag"));
  EXPECT_EQ(spec.model_version(), "");

  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{"evaluate", "--dataset=arm"},
        {"evaluate", "--dataset=arm", "--model=arm", "--protocol=loco"},
        {"evaluate", "--dataset=arm", "--protocol=odd"},
        {"evaluate", "--dataset=arm", "--model=arm@2", "--detach",
         "--report=" + Path("page")},
        {"evaluate", "--dataset=arm", "--protocol=loco", "--states=3"},
        {"evaluate", "--dataset=arm", "--data=arm.h5", "--model=arm"},
        {"evaluate", "--protocol=loco"}}) {
    EXPECT_EQ(Trainctl(wrong).exit, 2) << wrong.back();
  }
}

TEST_F(TrainctlRemoteTest, AnEvaluationOnTheServerHasAPage) {
  MakeDataset();
  v1::ModelVersion version;
  version.set_name("models/arm/versions/2");
  server_->AddModelVersion(version, "");
  v1::Operation job = Job(v1::Operation::STATE_SUCCEEDED);
  v1::EvaluationReport& report = *job.mutable_result()->mutable_evaluation();
  report.mutable_accuracy()->set_correct(3);
  report.mutable_accuracy()->set_contacts(4);
  report.mutable_accuracy()->set_low(0.301);
  report.mutable_accuracy()->set_high(0.954);
  report.set_never_felt(2);
  for (const char* name : {"<HU>", "SM"}) report.add_class_names(name);
  for (const uint32_t count : {2, 1, 0, 1}) report.add_confusion(count);
  report.add_anytime_s(0.5);
  *report.add_anytime() = report.accuracy();
  v1::ReliabilityBin& bin = *report.add_reliability();
  bin.set_low(0.6);
  bin.set_high(0.6667);
  bin.set_confidence(0.62);
  *bin.mutable_accuracy() = report.accuracy();
  server_->SetNewJobState(job);
  const Outcome outcome =
      Trainctl({"evaluate", "--dataset=arm", "--model=arm@2",
                "--report=" + Path("page")});
  ASSERT_EQ(outcome.exit, 0) << outcome.err;
  const std::string html = ReadText(Path("page/index.html"));
  for (const char* part :
       {"<h1>Evaluation on datasets/arm/versions/1</h1>",
        "models/arm/versions/2", ">75.00 %<", "3 of 4 felt contacts; 2 of 6",
        "30.10 to 95.40 %", "<bdi>&lt;HU&gt;</bdi>", ">66.67 %<",
        "<td>0.5</td>", "operations/1", "0.600 to 0.667", "0.620"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  EXPECT_THAT(html, Not(HasSubstr("<HU>")));
}

TEST_F(TrainctlRemoteTest, JobsAreListedAndCancelled) {
  MakeDataset();
  ASSERT_EQ(
      Trainctl({"train", "--dataset=arm", "--model=arm", "--detach"}).exit, 0);
  Outcome outcome = Trainctl({"jobs", "list"});
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("operations/1"), HasSubstr("queued"),
                    HasSubstr("models/arm on datasets/arm/versions/1")));
  EXPECT_EQ(Trainctl({"jobs", "list", "--state=failed", "--json"}).out, "[]\n");
  EXPECT_EQ(Trainctl({"jobs", "list", "--state=odd"}).exit, 2);
  std::thread user([&] {
    server_->AwaitWatchers(1);
    // A second client.
    TrainingClient client(server_->channel());
    EXPECT_TRUE(client.CancelOperation("operations/1").ok());
  });
  EXPECT_EQ(Trainctl({"jobs", "watch", "1"}).exit, 4);
  user.join();
  outcome = Trainctl({"jobs", "cancel", "1", "--json"});
  EXPECT_EQ(outcome.exit, 0);
  EXPECT_EQ(outcome.json()["state"], "cancelled");
}

TEST_F(TrainctlRemoteTest, ModelsAreServedAndRolledBack) {
  const std::string bundle = tactus::internal::testing::SealedBundle("a model");
  std::ofstream(Path("in.tactus")) << bundle;
  Outcome outcome = Trainctl(
      {"models", "import", "arm", "--bundle=" + Path("in.tactus"), "--json"});
  ASSERT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["sha256"], BundleSha256(bundle));
  outcome =
      Trainctl({"models", "export", "arm@1", "--out=" + Path("out.tactus")});
  ASSERT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_EQ(ReadBytes(Path("out.tactus")), bundle);

  v1::Alias alias;
  alias.set_name("aliases/default");
  alias.set_model_version("models/built-in/versions/1");
  alias.set_etag("e7");
  server_->SetAlias(alias);
  server_->SetNewJobState(Job(v1::Operation::STATE_SUCCEEDED));
  outcome = Trainctl({"models", "promote", "arm", "--force", "--etag=e7"});
  ASSERT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasSubstr("aliases/default is now models/arm/versions/1"));
  const v1::PromoteSpec spec = server_->last_promotion().spec();
  EXPECT_EQ(spec.alias(), "aliases/default");
  EXPECT_EQ(spec.etag(), "e7");
  EXPECT_TRUE(spec.force());

  outcome = Trainctl({"models", "show", "aliases/default", "--json"});
  EXPECT_EQ(outcome.json()["name"], "models/arm/versions/1");
  EXPECT_THAT(Trainctl({"models", "list"}).out,
              HasSubstr("models/arm/versions/1"));
  EXPECT_THAT(Trainctl({"models", "history"}).out,
              AllOf(HasSubstr("2023-11-14 22:13:20  models/arm/versions/1"),
                    HasSubstr("by anna  gate overruled")));
  EXPECT_EQ(Trainctl({"models", "delete", "arm@1"}).exit, 1);
  outcome = Trainctl({"models", "rollback"});
  EXPECT_THAT(outcome.out,
              HasSubstr("aliases/default -> models/built-in/versions/1"));
  EXPECT_EQ(Trainctl({"models", "delete", "arm@1"}).exit, 0);
  EXPECT_EQ(Trainctl({"models", "rollback", "other"}).exit, 1);
}

TEST_F(TrainctlRemoteTest, AGateThatIsNotPassedHasItsExitCode) {
  v1::ModelVersion version;
  version.set_name("models/arm/versions/2");
  server_->AddModelVersion(version, "");
  v1::Operation job = Failed(GateNotPassed("accuracy is 0.90, before 0.95"));
  v1::Comparison& comparison = *job.mutable_result()->mutable_comparison();
  comparison.set_failure("accuracy is 0.90, before 0.95");
  comparison.set_only_current(12);
  comparison.mutable_candidate()->mutable_accuracy()->set_correct(9);
  comparison.mutable_candidate()->mutable_accuracy()->set_contacts(10);
  server_->SetNewJobState(job);
  Outcome outcome = Trainctl({"models", "promote", "arm@2"});
  EXPECT_EQ(outcome.exit, 5);
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("gate not passed: accuracy is 0.90"),
                    HasSubstr("right on 12 contacts"), HasSubstr("90.00 %")));
  // A server that ends the job without an error.
  job.set_state(v1::Operation::STATE_SUCCEEDED);
  job.clear_error();
  server_->SetNewJobState(job);
  EXPECT_EQ(Trainctl({"models", "promote", "arm@2"}).exit, 5);
  EXPECT_EQ(Trainctl({"models", "promote", "arm@2", "--force"}).exit, 0);
}

TEST_F(TrainctlRemoteTest, AnAliasKeepsWhatIsNotNamed) {
  MakeDataset();
  v1::ModelVersion version;
  version.set_name("models/arm/versions/2");
  server_->AddModelVersion(version, "");
  Outcome outcome = Trainctl(
      {"models", "alias", "default", "--gate=arm", "--accuracy-margin=0.005"});
  ASSERT_EQ(outcome.exit, 0) << outcome.err;
  outcome = Trainctl({"models", "alias", "default", "--canary=arm@2",
                      "--canary-share=0.05", "--json"});
  ASSERT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["canary"]["per_mille"], 50);
  EXPECT_EQ(outcome.json()["gate"]["dataset_version"],
            "datasets/arm/versions/1");
  EXPECT_EQ(outcome.json()["gate"]["accuracy_margin"], 0.005);
  EXPECT_THAT(Trainctl({"models", "alias"}).out,
              HasSubstr("canary: models/arm/versions/2 for 5.0 %"));
  outcome = Trainctl({"models", "alias", "default", "--no-gate", "--json"});
  EXPECT_FALSE(outcome.json().contains("gate"));
  EXPECT_TRUE(outcome.json().contains("canary"));
  EXPECT_EQ(Trainctl({"models", "alias", "--no-gate"}).exit, 2);
  EXPECT_EQ(Trainctl({"models", "alias", "other"}).exit, 1);
}

TEST_F(TrainctlRemoteTest, EachTroubleSaysWhatToDo) {
  unsetenv("TACTUS_SERVER");
  Outcome outcome = Trainctl({"datasets", "list"});
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, HasSubstr("TACTUS_SERVER"));

  const std::string nobody = "--server=unix:" + Path("none");
  outcome = Trainctl({"datasets", "list", nobody});
  EXPECT_EQ(outcome.exit, 1);
  EXPECT_THAT(outcome.err, HasSubstr("Start one with tactusd --data-dir"));

  const std::string server = "--server=" + address_;
  server_->refuse = [](const std::string&) {
    return grpc::Status(grpc::StatusCode::UNIMPLEMENTED, "");
  };
  outcome = Trainctl({"datasets", "list", server});
  EXPECT_THAT(outcome.err, HasSubstr("install the same version on both"));

  outcome = Trainctl({"datasets", "list", server, "--tls-ca=" + Path("none")});
  EXPECT_THAT(outcome.err, HasSubstr("[IO]"));
  std::ofstream(Path("token")) << "secret\n";
  outcome = Trainctl({"datasets", "list", "--server=arm.lab:1",
                      "--token-file=" + Path("token")});
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr("unencrypted"), Not(HasSubstr("secret"))));
}

std::shared_ptr<grpc::ServerCredentials> Tls(
    const tactus::internal::testing::TlsFiles& files) {
  grpc::SslServerCredentialsOptions options;
  options.pem_key_cert_pairs.push_back(
      {ReadText(files.key()), ReadText(files.certificate())});
  return grpc::SslServerCredentials(options);
}

TEST_F(TrainctlRemoteTest, ARefusedCertificateSaysWhatToDo) {
  const tactus::internal::testing::TlsFiles files;
  const tactus::internal::testing::TlsFiles others;
  const tactus::internal::testing::TlsFiles elsewhere("DNS:elsewhere");
  ASSERT_TRUE(files.made() && others.made() && elsewhere.made());
  const auto list = [](const FakeTrainingServer& server,
                       const std::string& ca) {
    std::vector<std::string> arguments = {
        "datasets", "list",
        "--server=127.0.0.1:" + std::to_string(server.port())};
    if (!ca.empty()) arguments.push_back("--tls-ca=" + ca);
    return Trainctl(arguments);
  };
  const FakeTrainingServer server("127.0.0.1:0", Tls(files));
  EXPECT_EQ(list(server, files.certificate()).exit, 0);
  EXPECT_THAT(list(server, others.certificate()).err,
              HasSubstr("certificate was refused"));
  EXPECT_THAT(list(server, "").err, HasSubstr("closed the connection"));
  const FakeTrainingServer misnamed("127.0.0.1:0", Tls(elsewhere));
  EXPECT_THAT(list(misnamed, elsewhere.certificate()).err,
              HasSubstr("certificate was refused"));
  const FakeTrainingServer plain("127.0.0.1:0");
  EXPECT_THAT(list(plain, files.certificate()).err,
              HasSubstr("no TLS connection could be made"));
}

TEST(FullNameTest, ShortNamesBecomeFull) {
  EXPECT_EQ(FullName("datasets", "arm"), "datasets/arm");
  EXPECT_EQ(FullName("datasets", "arm@3"), "datasets/arm/versions/3");
  EXPECT_EQ(FullName("datasets", "datasets/arm/versions/3"),
            "datasets/arm/versions/3");
  EXPECT_EQ(FullName("operations", "7"), "operations/7");
}

}  // namespace
}  // namespace tactus::internal::client
