// Jobs that are cancelled, wait in a long queue, or run out of memory or room;
// and clients that want the same thing twice.
#include <sched.h>
#include <signal.h>
#include <sys/mount.h>

#include <cstdlib>
#include <set>
#include <thread>
#include <vector>

#include "absl/base/config.h"
#include "client/training/operation_watcher.h"
#include "client/training/training_client.h"
#include "core/base/errors.h"
#include "core/base/status_proto.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"
#include "tests/server/support/training_server.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using client::TrainingClient;
using ::testing::HasSubstr;
using testing::SmallPack;
using testing::SmallTraining;
using testing::TrainingServer;
using v1::Operation;

std::string Reason(const Operation& operation) {
  return ReasonOf(FromStatusProto(operation.error()));
}

class JobFaultsTest : public ::testing::Test {
 protected:
  // `process` may name another program than tactus-trainer.
  void Start(const server::JobProcess::Options& process = {},
             const std::string& folder = "",
             std::chrono::milliseconds store_interval =
                 server::JobQueue::Options().store_interval) {
    server_ = std::make_unique<TrainingServer>(server::TrainingBackend::Options{
        .folder = folder,
        .jobs = {.process = process, .store_interval = store_interval}});
    client_ = std::make_unique<TrainingClient>(server_->channel());
  }
  Operation Train(const v1::TrainModelRequest& request = SmallTraining()) {
    const auto operation = client_->TrainModel(request);
    EXPECT_TRUE(operation.ok()) << operation.status();
    return operation.ok() ? *operation : Operation();
  }
  // What lies in the folder of jobs.
  std::vector<std::string> JobFolders() {
    return *server_->backend().data().files().List(
        server_->backend().data().JobFolder());
  }
  // A trainer that does what the shell script says; $1 is the job's folder.
  std::string Script(const std::string& script) {
    const std::string program = folder_ / "trainer";
    WriteBytes(program, "#!/bin/sh\n" + script);
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    return program;
  }

  ScratchDir folder_;
  std::unique_ptr<TrainingServer> server_;
  std::unique_ptr<TrainingClient> client_;
};

// Every seventh point; each one if TACTUS_LONG is set.
TEST_F(JobFaultsTest, ATrainingIsCancelledAtEachPoint) {
  Start({}, "", std::chrono::milliseconds(0));
  server_->Upload("datasets/arm", SmallPack());
  // A network learns more slowly than HMMs do.
  v1::TrainModelRequest request = SmallTraining();
  request.mutable_spec()->set_networks(1);
  request.mutable_spec()->set_epochs(20);
  const int stride = std::getenv("TACTUS_LONG") == nullptr ? 7 : 1;
  int cancelled = 0;
  int succeeded = 0;
  size_t points = 1;
  for (size_t n = 1; n <= points && !HasFailure(); n += stride) {
    const std::string name = Train(request).name();
    size_t seen = 0;
    client::OperationWatcher watcher(client_.get(), {});
    const auto done =
        watcher.Watch(name, [&](const Operation&, const auto& news) {
          if (seen < n && seen + news.size() >= n) {
            EXPECT_TRUE(client_->CancelOperation(name).ok());
          }
          seen += news.size();
        });
    ASSERT_TRUE(done.ok()) << done.status();
    if (done->state() == Operation::STATE_CANCELLED) {
      ++cancelled;
      EXPECT_EQ(Reason(*done), "CANCELLED");
      EXPECT_EQ(done->result().model_version(), "");
    } else {
      ++succeeded;
      EXPECT_EQ(done->state(), Operation::STATE_SUCCEEDED)
          << done->ShortDebugString();
    }
    // The whole curve of a job that nobody cancelled.
    if (n == 1) {
      const std::string whole = Train(request).name();
      server_->Await(whole);
      points = server_->backend().operations().Points(whole)->size();
    }
  }
  std::printf("%zu points: %d jobs cancelled, %d succeeded\n", points,
              cancelled, succeeded);
  EXPECT_GT(cancelled, 5);
  EXPECT_EQ(server_->Await(Train().name()).state(), Operation::STATE_SUCCEEDED);
  EXPECT_TRUE(testing::Eventually([&] { return JobFolders().empty(); }));
}

TEST_F(JobFaultsTest, AHundredQueuedJobsEndInTheirOrder) {
  v1::JobOutcome outcome;
  outcome.mutable_result();
  WriteBytes(folder_ / "result", outcome.SerializeAsString());
  WriteBytes(folder_ / "bundle", *EncodeBundle(testing::SmallModel()));
  const std::string here = folder_.path();
  Start({.program =
             Script("while [ ! -e " + here + "/go ]; do sleep 0.02; " +
                    "done\n" + "cp " + here + "/bundle $1/bundle.tactus\ncp " +
                    here + "/result $1/result.pb\n")});
  server_->Upload("datasets/arm", SmallPack());
  std::vector<std::string> names;
  for (int i = 0; i < 100; ++i) names.push_back(Train().name());
  // Pages hold each of them once, the newest first.
  for (const int page : {1, 7, 100, 1'000}) {
    std::vector<std::string> listed;
    v1::ListOperationsRequest request;
    request.set_page_size(page);
    v1::ListOperationsResponse response;
    do {
      grpc::ClientContext context;
      ASSERT_TRUE(server_->operations()
                      .ListOperations(&context, request, &response)
                      .ok());
      EXPECT_LE(response.operations_size(), page);
      for (const Operation& operation : response.operations()) {
        listed.push_back(operation.name());
      }
      request.set_page_token(response.next_page_token());
    } while (!response.next_page_token().empty());
    EXPECT_EQ(listed, std::vector<std::string>(names.rbegin(), names.rend()));
  }
  EXPECT_TRUE(testing::Eventually([&] {
    return client_->GetOperation(names[0])->state() == Operation::STATE_RUNNING;
  }));
  EXPECT_EQ(client_->ListOperations(Operation::STATE_QUEUED, 1'000)->size(),
            99u);
  for (size_t i = 5; i < names.size(); i += 5) {
    EXPECT_EQ(client_->CancelOperation(names[i])->state(),
              Operation::STATE_CANCELLED);
  }
  WriteBytes(folder_ / "go", "");
  int64_t last = 0;
  int made = 0;
  for (size_t i = 0; i < names.size(); ++i) {
    const Operation done = server_->Await(names[i]);
    if (i % 5 == 0 && i > 0) {
      EXPECT_EQ(done.state(), Operation::STATE_CANCELLED);
      EXPECT_EQ(done.attempts(), 0u);
      continue;
    }
    ASSERT_EQ(done.state(), Operation::STATE_SUCCEEDED)
        << done.ShortDebugString();
    EXPECT_EQ(done.result().model_version(),
              "models/arm/versions/" + std::to_string(++made));
    EXPECT_GE(done.start_time_ms(), last);
    last = done.end_time_ms();
  }
  EXPECT_EQ(made, 81);
  EXPECT_TRUE(testing::Eventually([&] { return JobFolders().empty(); }));
}

TEST_F(JobFaultsTest, ADatasetIsNotDeletedWhileAJobTrainsOnIt) {
  Start();
  server_->Upload("datasets/arm", SmallPack());
  const std::string running = Train().name();
  const std::string queued = Train().name();
  int refused = 0;
  do {
    EXPECT_EQ(ReasonOf(client_->DeleteDataset("datasets/arm").status()),
              "DATASET_IN_USE");
    ++refused;
  } while (!server::HasEnded(*client_->GetOperation(queued)));
  std::printf("%d deletions were refused\n", refused);
  for (const std::string& name : {running, queued}) {
    EXPECT_EQ(server_->Await(name).state(), Operation::STATE_SUCCEEDED);
  }
  // The two versions came from it.
  EXPECT_EQ(ReasonOf(client_->DeleteDataset("datasets/arm").status()),
            "DATASET_IN_USE");
  for (const int version : {1, 2}) {
    EXPECT_TRUE(client_
                    ->DeleteModelVersion("models/arm/versions/" +
                                         std::to_string(version))
                    .ok());
  }
  EXPECT_EQ(*client_->DeleteDataset("datasets/arm"), 16u);
}

TEST_F(JobFaultsTest, ATrainerThatNeedsTooMuchMemorySaysSo) {
  Start({.memory_bytes = 40L << 20});
  std::string large;
  for (int i = 0; i < 16; ++i) {
    large += testing::Packed(testing::SmallTrial(i, 100'000));
  }
  // Sent in chunks, because of its size.
  v1::CreateUploadRequest create;
  ASSERT_TRUE(client_->CreateDataset("datasets/arm", "").ok());
  create.set_dataset("datasets/arm");
  const auto upload = client_->CreateUpload(create);
  ASSERT_TRUE(upload.ok()) << upload.status();
  ASSERT_EQ(server_->Write(upload->upload(), 0, large), "");
  v1::FinishUploadRequest finish;
  finish.set_upload(upload->upload());
  finish.set_size(static_cast<int64_t>(large.size()));
  finish.set_crc32c(ExtendCrc32c(0, large));
  ASSERT_TRUE(client_->FinishUpload(finish).ok());
  const Operation failed = server_->Await(Train().name());
  EXPECT_EQ(failed.state(), Operation::STATE_FAILED);
  EXPECT_EQ(Reason(failed), "JOB_CRASHED");
#ifndef ABSL_HAVE_ADDRESS_SANITIZER  // whose allocator ends the process itself
  EXPECT_THAT(failed.error().message(), HasSubstr("memory"));
  EXPECT_THAT(failed.error().message(), HasSubstr("40 MiB"));
#endif
  testing::ExpectGoodStream(server_->channel());
}

// A small disk of its own; skipped where the test may not mount one.
TEST_F(JobFaultsTest, ADiskThatFillsDuringTraining) {
  const std::string disk = folder_ / "disk";
  std::filesystem::create_directory(disk);
  if (unshare(CLONE_NEWNS) != 0 ||
      mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
      mount("tactus-test", disk.c_str(), "tmpfs", 0, "size=8m") != 0) {
    GTEST_SKIP() << "a tmpfs cannot be mounted here";
  }
  Start({.program = Script("echo $$ >" + (folder_ / "pid") + "\nwhile [ ! -e " +
                           (folder_ / "go") +
                           " ]; do sleep 0.02; done\nexec " TACTUS_TRAINER
                           " \"$@\"\n")},
        disk + "/data");
  ASSERT_EQ(server_->Upload("datasets/arm", SmallPack()),
            "datasets/arm/versions/1");
  const auto before = client_->GetDatasetVersion("datasets/arm");
  // The disk fills when the trainer already runs.
  const Operation job = Train();
  pid_t trainer = 0;
  ASSERT_TRUE(testing::Eventually([&] {
    return static_cast<bool>(std::ifstream(folder_ / "pid") >> trainer);
  }));
  {
    std::ofstream ballast(disk + "/ballast", std::ios::binary);
    const std::string block(4'096, 'x');
    while (ballast.write(block.data(), block.size()).flush()) {
    }
  }
  WriteBytes(folder_ / "go", "");
  EXPECT_TRUE(testing::Eventually([&] { return kill(trainer, 0) != 0; }));
  // Its end can be stored when the job's own files are gone, or some room is
  // back.
  std::filesystem::resize_file(disk + "/ballast", 7 << 20);
  const Operation failed = server_->Await(job.name());
  EXPECT_EQ(failed.state(), Operation::STATE_FAILED)
      << failed.ShortDebugString();
  EXPECT_EQ(Reason(failed), "STORAGE_FULL") << failed.ShortDebugString();
  EXPECT_THAT(failed.error().message(), HasSubstr(disk));
  testing::ExpectGoodStream(server_->channel());
  EXPECT_TRUE(testing::Eventually([&] { return JobFolders().empty(); }));

  std::filesystem::remove(disk + "/ballast");
  EXPECT_EQ(client_->GetDatasetVersion("datasets/arm")->sha256(),
            before->sha256());
  const Operation done = server_->Await(Train().name());
  EXPECT_EQ(done.state(), Operation::STATE_SUCCEEDED)
      << done.ShortDebugString();
  EXPECT_EQ(done.result().model_version(), "models/arm/versions/1");
  server_.reset();
  umount(disk.c_str());
}

TEST_F(JobFaultsTest, TwoWritersOfOneUpload) {
  Start();
  const std::string pack = SmallPack();
  ASSERT_TRUE(client_->CreateDataset("datasets/arm", "").ok());
  v1::CreateUploadRequest create;
  create.set_dataset("datasets/arm");
  const std::string upload = client_->CreateUpload(create)->upload();
  // Both always send what the server does not have yet, a kilobyte a call.
  std::atomic<int> busy = 0;
  const auto write = [&] {
    int64_t size = 0;
    while (size < static_cast<int64_t>(pack.size())) {
      const auto status = client_->QueryWriteStatus(upload);
      ASSERT_TRUE(status.ok()) << status.status();
      ASSERT_GE(status->committed_size(), size);
      size = status->committed_size();
      const std::string chunk = pack.substr(static_cast<size_t>(size), 1'000);
      if (chunk.empty()) return;
      const std::string reason = server_->Write(upload, size, chunk);
      // The other writer holds the upload, or has just written.
      busy += reason == "UPLOAD_BUSY" ? 1 : 0;
      EXPECT_THAT(reason,
                  ::testing::AnyOf("", "UPLOAD_BUSY", "OFFSET_MISMATCH"));
    }
  };
  std::thread first(write);
  std::thread second(write);
  first.join();
  second.join();
  std::printf("the upload was busy %d times\n", busy.load());
  v1::FinishUploadRequest finish;
  finish.set_upload(upload);
  finish.set_size(static_cast<int64_t>(pack.size()));
  finish.set_crc32c(ExtendCrc32c(0, pack));
  const auto finished = client_->FinishUpload(finish);
  ASSERT_TRUE(finished.ok()) << finished.status();
  EXPECT_EQ(finished->version().trials(), 16u);

  // While one call is open, a second one is refused, and so is the end.
  const std::string other = client_->CreateUpload(create)->upload();
  v1::WriteUploadRequest chunk;
  chunk.set_upload(other);
  chunk.set_data(pack);
  chunk.set_crc32c(ExtendCrc32c(0, pack));
  grpc::ClientContext context;
  v1::WriteUploadResponse response;
  const auto open = server_->training().WriteUpload(&context, &response);
  ASSERT_TRUE(open->Write(chunk));
  // At a wrong offset, so that one that comes before that call is refused.
  EXPECT_TRUE(testing::Eventually(
      [&] { return server_->Write(other, 7, pack) == "UPLOAD_BUSY"; }));
  finish.set_upload(other);
  EXPECT_EQ(ReasonOf(client_->FinishUpload(finish).status()), "UPLOAD_BUSY");
  open->WritesDone();
  EXPECT_TRUE(open->Finish().ok());
  EXPECT_TRUE(client_->FinishUpload(finish).ok());
}

// Eight clients at once ask for the same thing; there is one.
TEST_F(JobFaultsTest, ARequestIdGivesOneThingToAllWhoAskAtOnce) {
  Start({.program = Script("exec sleep 1000\n")});
  server_->Upload("datasets/arm", SmallPack());
  std::mutex mutex;
  std::set<std::string> uploads;
  std::set<std::string> trainings;
  std::set<std::string> evaluations;
  std::vector<std::thread> clients;
  for (int i = 0; i < 8; ++i) {
    clients.emplace_back([&] {
      v1::CreateUploadRequest create;
      create.set_dataset("datasets/arm");
      create.set_request_id("one");
      const auto upload = client_->CreateUpload(create);
      v1::TrainModelRequest train = SmallTraining();
      train.set_request_id("one");
      const auto training = client_->TrainModel(train);
      v1::EvaluateModelRequest evaluate;
      evaluate.mutable_spec()->set_dataset_version("datasets/arm");
      evaluate.mutable_spec()->set_model_version("models/default");
      evaluate.set_request_id("another");
      const auto evaluation = client_->EvaluateModel(evaluate);
      const std::lock_guard lock(mutex);
      ASSERT_TRUE(upload.ok() && training.ok() && evaluation.ok());
      uploads.insert(upload->upload());
      trainings.insert(training->name());
      evaluations.insert(evaluation->name());
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(uploads.size(), 1u);
  EXPECT_EQ(trainings.size(), 1u);
  EXPECT_EQ(evaluations.size(), 1u);
  EXPECT_EQ(client_->ListOperations(Operation::STATE_UNSPECIFIED, 10)->size(),
            2u);
}

// A promotion that arrives again, late, must not undo a rollback.
TEST_F(JobFaultsTest, APromotionThatArrivesTwiceMovesTheAliasOnce) {
  Start();
  const std::string bundle = *EncodeBundle(testing::SmallModel());
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(client_->ImportModel("models/arm", bundle).ok());
  }
  const auto promote = [&](int version, const std::string& id) {
    v1::PromoteModelRequest request;
    request.mutable_spec()->set_alias("aliases/a");
    request.mutable_spec()->set_model_version("models/arm/versions/" +
                                              std::to_string(version));
    request.set_request_id(id);
    return client_->PromoteModel(request);
  };
  ASSERT_TRUE(promote(1, "first").ok());
  const auto moved = promote(2, "second");
  ASSERT_TRUE(moved.ok()) << moved.status();
  ASSERT_TRUE(client_->RollbackAlias("aliases/a", "").ok());
  const auto again = promote(2, "second");
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->name(), moved->name());
  EXPECT_EQ(client_->ListAliases()->front().model_version(),
            "models/arm/versions/1");
  EXPECT_EQ(client_->ListAliasHistory("aliases/a")->size(), 3u);

  // With an etag that the promotion itself has changed.
  v1::UpdateAliasRequest gate;
  gate.set_name("aliases/a");
  server_->Upload("datasets/arm", SmallPack());
  gate.mutable_gate()->set_dataset_version("datasets/arm");
  const auto gated = client_->UpdateAlias(gate);
  ASSERT_TRUE(gated.ok()) << gated.status();
  v1::PromoteModelRequest request;
  request.mutable_spec()->set_alias("aliases/a");
  request.mutable_spec()->set_model_version("models/arm/versions/2");
  request.mutable_spec()->set_etag(gated->etag());
  request.set_request_id("third");
  const auto job = client_->PromoteModel(request);
  ASSERT_TRUE(job.ok()) << job.status();
  ASSERT_EQ(server_->Await(job->name()).state(), Operation::STATE_SUCCEEDED);
  const auto repeated = client_->PromoteModel(request);
  ASSERT_TRUE(repeated.ok()) << repeated.status();
  EXPECT_EQ(repeated->name(), job->name());
}

}  // namespace
}  // namespace tactus::internal
