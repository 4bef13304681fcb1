// File: fake_training_server.h
//
// FakeTrainingServer: a small training service in memory, with faults on
// request, for the tests of its clients. It trains nothing: tests say what
// happens to a job.
//
//   FakeTrainingServer server;
//   server.BreakUploadAt(4096, FakeTrainingServer::Kept::kHalf);
//   TrainingClient client(server.channel());
//
// Thread-safe.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "google/protobuf/message.h"
#include "grpcpp/channel.h"
#include "grpcpp/security/server_credentials.h"
#include "grpcpp/server.h"
#include "tactus/v1/models.grpc.pb.h"
#include "tactus/v1/operations.grpc.pb.h"
#include "tactus/v1/training.grpc.pb.h"

namespace tactus::internal::client::testing {

struct FakeState;
class FakeTrainingService;
class FakeOperationService;
class FakeModelService;

class FakeTrainingServer {
 public:
  // Which of the bytes that a broken call sent stay.
  enum class Kept { kNone, kHalf, kAll };

  // Listens in the process, and at `address` unless it is empty.
  explicit FakeTrainingServer(
      const std::string& address = "",
      const std::shared_ptr<grpc::ServerCredentials>& credentials =
          grpc::InsecureServerCredentials());
  ~FakeTrainingServer();

  std::shared_ptr<grpc::Channel> channel();
  // Port of `address`, if that left the choice to the system.
  int port() const { return port_; }

  // Called with each response before it is sent.
  std::function<void(google::protobuf::Message&)> alter;
  // Called with the name of each RPC; any error ends it.
  std::function<grpc::Status(const std::string& method)> refuse;
  // Size of the messages of a download.
  size_t download_bytes = 1000;

  // The next WriteUpload call that has received `bytes` of its upload ends with
  // UNAVAILABLE.
  void BreakUploadAt(int64_t bytes, Kept kept);
  // So does the next DownloadTrials call that has sent `bytes`.
  void BreakDownloadAt(int64_t bytes);
  // The next `count` WatchOperation calls end with UNAVAILABLE after the
  // history.
  void BreakWatches(int count);

  // Bytes of WriteUpload messages and number of its calls so far.
  int64_t bytes_received();
  int write_calls();
  // Trials of the newest version, as they were uploaded.
  std::string PackOf(const std::string& dataset);
  v1::TrainSpec last_train_spec();
  v1::PromoteModelRequest last_promotion();
  v1::UpdateAliasRequest last_update();

  // Replaces an operation, or adds it.
  void SetOperation(const v1::Operation& operation);
  void AddPoint(const std::string& operation, const v1::LearningPoint& point);
  // The state that the operations of new jobs have.
  void SetNewJobState(const v1::Operation& pattern);
  v1::Operation operation(const std::string& name);
  // Waits until this many watches wait for news.
  void AwaitWatchers(int count);

  void AddModelVersion(const v1::ModelVersion& version,
                       const std::string& bundle);
  void SetAlias(const v1::Alias& alias);

 private:
  std::unique_ptr<FakeState> state_;
  std::unique_ptr<FakeTrainingService> training_;
  std::unique_ptr<FakeOperationService> operations_;
  std::unique_ptr<FakeModelService> models_;
  std::unique_ptr<grpc::Server> server_;
  int port_ = 0;
};

}  // namespace tactus::internal::client::testing
