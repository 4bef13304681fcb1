// File: training_client.h
//
// TrainingClient: the training service of one server, call by call. Each method
// is one RPC of proto/tactus/v1/{training,operations,models}.proto and blocks
// until the server has answered.
//
//   TrainingClient client(MakeTrainingChannel("arm.lab:50051", {}));
//   TACTUS_ASSIGN_OR_RETURN(const v1::Dataset dataset,
//                           client.CreateDataset("datasets/arm", "first arm"));
//
// Uploads, downloads and watches take many messages and survive broken
// connections: trial_uploader.h, trial_downloader.h, operation_watcher.h.
//
// Errors are the server's, with its reason; UNAVAILABLE without a reason if no
// server answered; NO_RESPONSE after the timeout; INVALID_RESPONSE if the
// answer is not one to the request. No method repeats a call.
//
// Thread-safe. Shares ownership of the channel.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/stream/channel.h"
#include "grpcpp/client_context.h"
#include "tactus/v1/admin.grpc.pb.h"
#include "tactus/v1/contact_log.grpc.pb.h"
#include "tactus/v1/models.grpc.pb.h"
#include "tactus/v1/monitor.grpc.pb.h"
#include "tactus/v1/operations.grpc.pb.h"
#include "tactus/v1/training.grpc.pb.h"

namespace tactus::internal::client {

// A channel that takes the larger responses of the training service.
std::shared_ptr<grpc::Channel> MakeTrainingChannel(const std::string& address,
                                                   ChannelOptions options);

struct TrainingClientOptions {
  // Sent as "authorization: Bearer ..." with every call; empty: none.
  std::string token = {};
  // For one call; those that check or move much data get ten times as much.
  std::chrono::milliseconds timeout{60'000};
};

class TrainingClient {
 public:
  explicit TrainingClient(std::shared_ptr<grpc::Channel> channel,
                          TrainingClientOptions options = {});

  // Datasets.
  absl::StatusOr<v1::Dataset> CreateDataset(const std::string& name,
                                            const std::string& description);
  absl::StatusOr<v1::GetDatasetResponse> GetDataset(const std::string& name);
  absl::StatusOr<std::vector<v1::Dataset>> ListDatasets();
  // Returns the number of trials that were removed from disk.
  absl::StatusOr<uint32_t> DeleteDataset(const std::string& name);
  // The new version. With a request id, a call may be repeated.
  absl::StatusOr<v1::DatasetVersion> RelabelTrials(
      const v1::RelabelTrialsRequest& request);
  absl::StatusOr<v1::DatasetVersion> RemoveTrials(
      const v1::RemoveTrialsRequest& request);
  // `name` may be that of a dataset, for its newest version.
  absl::StatusOr<v1::DatasetVersion> GetDatasetVersion(const std::string& name);
  // All pages; `filter` without page fields.
  absl::StatusOr<std::vector<v1::TrialInfo>> ListTrials(
      v1::ListTrialsRequest filter);

  // Uploads.
  absl::StatusOr<v1::CreateUploadResponse> CreateUpload(
      const v1::CreateUploadRequest& request);
  absl::StatusOr<v1::QueryWriteStatusResponse> QueryWriteStatus(
      const std::string& upload);
  absl::StatusOr<v1::FinishUploadResponse> FinishUpload(
      const v1::FinishUploadRequest& request);

  // Jobs. With `validate_only` the operation has no name.
  absl::StatusOr<v1::Operation> TrainModel(
      const v1::TrainModelRequest& request);
  absl::StatusOr<v1::Operation> EvaluateModel(
      const v1::EvaluateModelRequest& request);
  absl::StatusOr<v1::Operation> GetOperation(const std::string& name);
  // At most `limit`, the newest first; in any state if `state` is unspecified.
  absl::StatusOr<std::vector<v1::Operation>> ListOperations(
      v1::Operation::State state, size_t limit);
  absl::StatusOr<v1::Operation> CancelOperation(const std::string& name);
  absl::Status DeleteOperation(const std::string& name);

  // Models. `model` empty: the versions of all.
  absl::StatusOr<std::vector<v1::ModelVersion>> ListModelVersions(
      const std::string& model);
  // `name` may be that of a model, for its newest version, or of an alias.
  absl::StatusOr<v1::ModelVersion> GetModelVersion(const std::string& name);
  absl::Status DeleteModelVersion(const std::string& name);
  // The bundle of a version, checked against its SHA-256.
  absl::StatusOr<std::string> ExportModel(const std::string& name);
  absl::StatusOr<v1::ModelVersion> ImportModel(const std::string& model,
                                               absl::string_view bundle);

  // Aliases.
  absl::StatusOr<std::vector<v1::Alias>> ListAliases();
  absl::StatusOr<v1::Alias> UpdateAlias(const v1::UpdateAliasRequest& request);
  absl::StatusOr<v1::Operation> PromoteModel(
      const v1::PromoteModelRequest& request);
  absl::StatusOr<v1::Alias> RollbackAlias(const std::string& name,
                                          const std::string& etag);
  absl::StatusOr<std::vector<v1::AliasChange>> ListAliasHistory(
      const std::string& name);

  // For calls of many messages: a context with the token, and a deadline unless
  // `timeout` is 0.
  std::unique_ptr<grpc::ClientContext> NewContext(
      std::chrono::milliseconds timeout) const;
  // The error of a call; `what` names it for NO_RESPONSE.
  static absl::Status ErrorOf(const grpc::Status& status, const char* what,
                              std::chrono::milliseconds timeout);
  v1::TrainingService::Stub& training() { return *training_; }
  v1::OperationService::Stub& operations() { return *operations_; }
  v1::AdminService::Stub& admin() { return *admin_; }
  v1::MonitorService::Stub& monitor() { return *monitor_; }
  v1::ContactLogService::Stub& contact_log() { return *contact_log_; }
  std::chrono::milliseconds timeout() const { return options_.timeout; }
  std::chrono::milliseconds long_timeout() const {
    return 10 * options_.timeout;
  }

 private:
  const TrainingClientOptions options_;
  const std::unique_ptr<v1::TrainingService::Stub> training_;
  const std::unique_ptr<v1::OperationService::Stub> operations_;
  const std::unique_ptr<v1::ModelService::Stub> models_;
  const std::unique_ptr<v1::AdminService::Stub> admin_;
  const std::unique_ptr<v1::MonitorService::Stub> monitor_;
  const std::unique_ptr<v1::ContactLogService::Stub> contact_log_;
};

// The version "datasets/D/versions/V" or "models/M/versions/V" of a resource.
std::string VersionName(absl::string_view resource, uint64_t version);

}  // namespace tactus::internal::client
