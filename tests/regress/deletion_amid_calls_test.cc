// TrainModel and EvaluateModel looked a dataset up twice and did not check the
// second answer: a deletion in between ended the server, with all its streams.
// A download that met a deletion reported damaged storage.
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "client/stream/status.h"
#include "core/base/errors.h"
#include "core/base/status_proto.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"
#include "tests/server/support/training_server.h"

namespace tactus::internal {
namespace {

using std::chrono::milliseconds;
using testing::TrainingServer;

constexpr int kThreads = 32;
constexpr const char* kDatasets[] = {"datasets/a", "datasets/b", "datasets/c"};

// How long the threads work. The long test gives a minute.
milliseconds WorkTime() {
  const char* seconds = std::getenv("TACTUS_RACE_SECONDS");
  return milliseconds(1'000) * (seconds == nullptr ? 2 : std::atoi(seconds));
}

// How calls ended: by method, the number of each reason; OK is "".
class Outcomes {
 public:
  void Add(const std::string& method, const grpc::Status& status) {
    const std::string reason = ReasonOf(client::FromGrpcStatus(status));
    Count(method, status.ok()      ? ""
                  : reason.empty() ? status.error_message()
                                   : reason);
  }
  void Count(const std::string& method, const std::string& reason) {
    const std::lock_guard lock(mutex_);
    ++counts_[method][reason];
  }
  const std::map<std::string, std::map<std::string, int>>& counts() const {
    return counts_;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::map<std::string, int>> counts_;
};

// What one of the threads does, over and over.
class Worker {
 public:
  Worker(TrainingServer& server, Outcomes& outcomes)
      : server_(server), outcomes_(outcomes) {}

  // One turn of the kind of work that `thread` does.
  void Turn(int thread, int turn) {
    dataset_ = kDatasets[(thread + turn) % std::size(kDatasets)];
    turn_ = turn;
    switch (thread % 8) {
      case 0:
      case 1:
        return Fill();
      case 2:
      case 3:
        return Delete();
      case 4:
        return Train();
      case 5:
        return Evaluate();
      case 6:
        return Read();
      default:
        return thread < 16 ? ChangeModels() : Promote();
    }
  }

 private:
  // Makes one call and counts its end.
  template <typename Response, typename Call, typename Request>
  Response Do(const char* method, const Call& call, const Request& request) {
    grpc::ClientContext context;
    Response response;
    outcomes_.Add(method, call(&context, request, &response));
    return response;
  }

  void Fill() {
    v1::CreateDatasetRequest create;
    create.set_name(dataset_);
    Do<v1::CreateDatasetResponse>(
        "CreateDataset",
        [&](auto... a) { return server_.training().CreateDataset(a...); },
        create);
    v1::CreateUploadRequest begin;
    begin.set_dataset(dataset_);
    const auto upload = Do<v1::CreateUploadResponse>(
        "CreateUpload",
        [&](auto... a) { return server_.training().CreateUpload(a...); },
        begin);
    if (upload.upload().empty()) return;
    const std::string pack = testing::SmallPack(0, 8, 20);
    EXPECT_EQ(server_.Write(upload.upload(), 0, pack), "");
    v1::FinishUploadRequest finish;
    finish.set_upload(upload.upload());
    finish.set_size(static_cast<int64_t>(pack.size()));
    finish.set_crc32c(ExtendCrc32c(0, pack));
    Do<v1::FinishUploadResponse>(
        "FinishUpload",
        [&](auto... a) { return server_.training().FinishUpload(a...); },
        finish);
  }

  void Delete() {
    v1::DeleteDatasetRequest request;
    request.set_name(dataset_);
    Do<v1::DeleteDatasetResponse>(
        "DeleteDataset",
        [&](auto... a) { return server_.training().DeleteDataset(a...); },
        request);
  }

  // Most jobs are only checked or cancelled at once: a job that waits keeps its
  // dataset from being deleted.
  void Train() {
    v1::TrainModelRequest request = testing::SmallTraining();
    request.mutable_spec()->set_dataset_version(dataset_);
    request.set_validate_only(turn_ % 2 == 0);
    Cancel(Do<v1::TrainModelResponse>(
               "TrainModel",
               [&](auto... a) { return server_.training().TrainModel(a...); },
               request)
               .operation()
               .name());
  }

  void Evaluate() {
    v1::EvaluateModelRequest request;
    request.mutable_spec()->set_dataset_version(dataset_);
    request.mutable_spec()->set_model_version(
        turn_ % 4 == 1 ? "models/m" : "models/default");
    request.set_validate_only(turn_ % 2 == 0);
    Cancel(
        Do<v1::EvaluateModelResponse>(
            "EvaluateModel",
            [&](auto... a) { return server_.training().EvaluateModel(a...); },
            request)
            .operation()
            .name());
  }

  void Cancel(const std::string& job) {
    if (job.empty() || turn_ % 16 == 15) return;
    v1::CancelOperationRequest request;
    request.set_name(job);
    Do<v1::CancelOperationResponse>(
        "CancelOperation",
        [&](auto... a) { return server_.operations().CancelOperation(a...); },
        request);
  }

  void Read() {
    v1::DownloadTrialsRequest download;
    download.set_dataset_version(dataset_);
    grpc::ClientContext context;
    const auto reader = server_.training().DownloadTrials(&context, download);
    v1::DownloadTrialsResponse part;
    while (reader->Read(&part)) {
    }
    outcomes_.Add("DownloadTrials", reader->Finish());
    v1::ListTrialsRequest trials;
    trials.set_dataset_version(dataset_);
    Do<v1::ListTrialsResponse>(
        "ListTrials",
        [&](auto... a) { return server_.training().ListTrials(a...); }, trials);
    v1::GetDatasetRequest dataset;
    dataset.set_name(dataset_);
    const auto got = Do<v1::GetDatasetResponse>(
        "GetDataset",
        [&](auto... a) { return server_.training().GetDataset(a...); },
        dataset);
    if (got.versions_size() > 0) {
      EXPECT_EQ(
          got.versions(got.versions_size() - 1).name(),
          absl::StrCat(dataset_, "/versions/", got.dataset().latest_version()));
    }
  }

  void ChangeModels() {
    const auto version = server_.backend().models().AddVersion(
        "models/m", *EncodeBundle(testing::SmallModel()), {}, {"test", ""});
    ASSERT_TRUE(version.ok()) << version.status();
    // Other threads export and list the version while it goes.
    v1::ExportModelRequest request;
    request.set_name("models/m");
    grpc::ClientContext context;
    const auto reader = server_.models().ExportModel(&context, request);
    v1::ExportModelResponse part;
    while (reader->Read(&part)) {
    }
    outcomes_.Add("ExportModel", reader->Finish());
    Do<v1::ListModelVersionsResponse>(
        "ListModelVersions",
        [&](auto... a) { return server_.models().ListModelVersions(a...); },
        v1::ListModelVersionsRequest());
    v1::DeleteModelVersionRequest remove;
    remove.set_name(version->name());
    Do<v1::DeleteModelVersionResponse>(
        "DeleteModelVersion",
        [&](auto... a) { return server_.models().DeleteModelVersion(a...); },
        remove);
  }

  void Promote() {
    v1::UpdateAliasRequest alias;
    alias.set_name("aliases/default");
    if (turn_ % 2 == 0) alias.mutable_gate()->set_dataset_version(dataset_);
    Do<v1::UpdateAliasResponse>(
        "UpdateAlias",
        [&](auto... a) { return server_.models().UpdateAlias(a...); }, alias);
    v1::PromoteModelRequest request;
    request.mutable_spec()->set_alias("aliases/default");
    request.mutable_spec()->set_model_version("models/default/versions/1");
    Cancel(Do<v1::PromoteModelResponse>(
               "PromoteModel",
               [&](auto... a) { return server_.models().PromoteModel(a...); },
               request)
               .operation()
               .name());
  }

  TrainingServer& server_;
  Outcomes& outcomes_;
  std::string dataset_;
  int turn_ = 0;
};

TEST(DeletionAmidCallsTest, EveryCallEndsWithItsReason) {
  TrainingServer server;
  Outcomes outcomes;
  std::atomic<bool> done = false;
  std::vector<std::thread> threads;
  for (int thread = 0; thread < kThreads; ++thread) {
    threads.emplace_back([&, thread] {
      Worker worker(server, outcomes);
      for (int turn = 0; !done; ++turn) worker.Turn(thread, turn);
    });
  }
  testing::RawStream robot(server.channel());
  EXPECT_TRUE(robot.Write(testing::ConfigRequest()));
  EXPECT_TRUE(robot.Read().has_started());
  std::this_thread::sleep_for(WorkTime());
  done = true;
  for (std::thread& thread : threads) thread.join();
  robot.HalfClose();
  EXPECT_TRUE(robot.Finish().ok());

  // What may come of a race. Damaged storage and errors without a reason may
  // not.
  const std::set<std::string> allowed = {"",
                                         "DATASET_NOT_FOUND",
                                         "DATASET_EXISTS",
                                         "DATASET_IN_USE",
                                         "MODEL_NOT_FOUND",
                                         "MODEL_IN_USE",
                                         "JOB_LIMIT",
                                         "QUOTA_EXCEEDED"};
  for (const auto& [method, reasons] : outcomes.counts()) {
    for (const auto& [reason, count] : reasons) {
      EXPECT_THAT(allowed, ::testing::Contains(reason))
          << method << ", " << count << " times";
    }
    EXPECT_GT(reasons.contains("") ? reasons.at("") : 0, 0)
        << method << " never succeeded";
  }
  v1::ListOperationsRequest request;
  request.set_page_size(1'000);
  v1::ListOperationsResponse jobs;
  grpc::ClientContext context;
  ASSERT_TRUE(
      server.operations().ListOperations(&context, request, &jobs).ok());
  for (const v1::Operation& job : jobs.operations()) {
    if (job.state() != v1::Operation::STATE_FAILED) continue;
    const std::string reason = ReasonOf(FromStatusProto(job.error()));
    EXPECT_NE(reason, "DATA_LOST") << job.ShortDebugString();
    EXPECT_NE(reason, "JOB_CRASHED") << job.ShortDebugString();
  }
}

}  // namespace
}  // namespace tactus::internal
