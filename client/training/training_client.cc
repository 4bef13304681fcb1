#include "client/training/training_client.h"

#include <iterator>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/stream/status.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/bundle/bundle.h"

namespace tactus::internal::client {
namespace {

using std::chrono::milliseconds;

// Twice gRPC's default: GetDataset returns all versions at once.
constexpr int kMaxResponseBytes = 8 * 1024 * 1024;
constexpr int kPageSize = 1'000;
// Largest message of ImportModel, by the contract.
constexpr size_t kChunkBytes = 1024 * 1024;

// One call with one request and one response.
template <typename Stub, typename Request, typename Response>
absl::StatusOr<Response> Call(const TrainingClient& client, Stub& stub,
                              grpc::Status (Stub::*method)(grpc::ClientContext*,
                                                           const Request&,
                                                           Response*),
                              const Request& request, const char* what,
                              milliseconds timeout) {
  const auto context = client.NewContext(timeout);
  Response response;
  const grpc::Status status = (stub.*method)(context.get(), request, &response);
  if (!status.ok()) return TrainingClient::ErrorOf(status, what, timeout);
  return response;
}

// INVALID_RESPONSE unless the server speaks of the thing that it was asked for.
absl::Status CheckName(const char* what, const std::string& got,
                       const std::string& want) {
  if (got == want) return absl::OkStatus();
  return InvalidResponse(what, Quoted(got), Quoted(want));
}

// The same for a name that the server chooses.
absl::Status CheckPrefix(const char* what, const std::string& got,
                         const char* prefix) {
  if (absl::StartsWith(got, prefix)) return absl::OkStatus();
  return InvalidResponse(what, Quoted(got),
                         absl::StrCat("a name that begins with ", prefix));
}

absl::StatusOr<v1::Operation> CheckOperation(v1::Operation operation,
                                             bool validate_only) {
  if (validate_only && operation.name().empty()) return operation;
  TACTUS_RETURN_IF_ERROR(
      CheckPrefix("operation.name", operation.name(), "operations/"));
  return operation;
}

// Asks for one page after another; `take` moves the items out of a response
// and returns false if it wants no more.
template <typename Request, typename Ask, typename Take>
absl::Status EachPage(Request request, const Ask& ask, const Take& take) {
  request.set_page_size(kPageSize);
  for (;;) {
    auto response = ask(request);
    if (!response.ok()) return response.status();
    const std::string next = response->next_page_token();
    if (!take(*response) || next.empty()) return absl::OkStatus();
    if (next == request.page_token()) {
      return InvalidResponse("next_page_token", Quoted(next),
                             "another one than that of the request");
    }
    request.set_page_token(next);
  }
}

template <typename Item>
void MoveAll(google::protobuf::RepeatedPtrField<Item>& from,
             std::vector<Item>* to) {
  to->insert(to->end(), std::make_move_iterator(from.begin()),
             std::make_move_iterator(from.end()));
}

}  // namespace

std::shared_ptr<grpc::Channel> MakeTrainingChannel(const std::string& address,
                                                   ChannelOptions options) {
  options.max_receive_bytes = kMaxResponseBytes;
  return MakeChannel(address, options);
}

std::string VersionName(absl::string_view resource, uint64_t version) {
  return absl::StrCat(resource, "/versions/", version);
}

TrainingClient::TrainingClient(std::shared_ptr<grpc::Channel> channel,
                               TrainingClientOptions options)
    : options_(std::move(options)),
      training_(v1::TrainingService::NewStub(channel)),
      operations_(v1::OperationService::NewStub(channel)),
      models_(v1::ModelService::NewStub(channel)),
      admin_(v1::AdminService::NewStub(channel)),
      monitor_(v1::MonitorService::NewStub(channel)),
      contact_log_(v1::ContactLogService::NewStub(channel)) {}

std::unique_ptr<grpc::ClientContext> TrainingClient::NewContext(
    milliseconds timeout) const {
  auto context = std::make_unique<grpc::ClientContext>();
  if (timeout.count() > 0) {
    context->set_deadline(std::chrono::system_clock::now() + timeout);
  }
  if (!options_.token.empty()) {
    context->AddMetadata("authorization",
                         absl::StrCat("Bearer ", options_.token));
  }
  return context;
}

absl::Status TrainingClient::ErrorOf(const grpc::Status& status,
                                     const char* what, milliseconds timeout) {
  absl::Status error = FromGrpcStatus(status);
  if (error.code() == absl::StatusCode::kDeadlineExceeded &&
      ReasonOf(error).empty()) {
    return NoResponse(what, timeout.count());
  }
  return error;
}

absl::StatusOr<v1::Dataset> TrainingClient::CreateDataset(
    const std::string& name, const std::string& description) {
  v1::CreateDatasetRequest request;
  request.set_name(name);
  request.set_description(description);
  TACTUS_ASSIGN_OR_RETURN(
      v1::CreateDatasetResponse response,
      Call(*this, *training_, &v1::TrainingService::Stub::CreateDataset,
           request, "CreateDataset", timeout()));
  TACTUS_RETURN_IF_ERROR(
      CheckName("dataset.name", response.dataset().name(), name));
  return std::move(*response.mutable_dataset());
}

absl::StatusOr<v1::GetDatasetResponse> TrainingClient::GetDataset(
    const std::string& name) {
  v1::GetDatasetRequest request;
  request.set_name(name);
  TACTUS_ASSIGN_OR_RETURN(
      v1::GetDatasetResponse response,
      Call(*this, *training_, &v1::TrainingService::Stub::GetDataset, request,
           "GetDataset", timeout()));
  TACTUS_RETURN_IF_ERROR(
      CheckName("dataset.name", response.dataset().name(), name));
  return response;
}

absl::StatusOr<std::vector<v1::Dataset>> TrainingClient::ListDatasets() {
  std::vector<v1::Dataset> datasets;
  TACTUS_RETURN_IF_ERROR(EachPage(
      v1::ListDatasetsRequest(),
      [&](const v1::ListDatasetsRequest& request) {
        return Call(*this, *training_, &v1::TrainingService::Stub::ListDatasets,
                    request, "ListDatasets", timeout());
      },
      [&](v1::ListDatasetsResponse& response) {
        MoveAll(*response.mutable_datasets(), &datasets);
        return true;
      }));
  return datasets;
}

absl::StatusOr<uint32_t> TrainingClient::DeleteDataset(
    const std::string& name) {
  v1::DeleteDatasetRequest request;
  request.set_name(name);
  TACTUS_ASSIGN_OR_RETURN(
      const v1::DeleteDatasetResponse response,
      Call(*this, *training_, &v1::TrainingService::Stub::DeleteDataset,
           request, "DeleteDataset", long_timeout()));
  return response.removed_trials();
}

absl::StatusOr<v1::DatasetVersion> TrainingClient::RelabelTrials(
    const v1::RelabelTrialsRequest& request) {
  TACTUS_ASSIGN_OR_RETURN(
      v1::RelabelTrialsResponse response,
      Call(*this, *training_, &v1::TrainingService::Stub::RelabelTrials,
           request, "RelabelTrials", long_timeout()));
  TACTUS_RETURN_IF_ERROR(
      CheckPrefix("version.name", response.version().name(), "datasets/"));
  return std::move(*response.mutable_version());
}

absl::StatusOr<v1::DatasetVersion> TrainingClient::RemoveTrials(
    const v1::RemoveTrialsRequest& request) {
  TACTUS_ASSIGN_OR_RETURN(
      v1::RemoveTrialsResponse response,
      Call(*this, *training_, &v1::TrainingService::Stub::RemoveTrials, request,
           "RemoveTrials", long_timeout()));
  TACTUS_RETURN_IF_ERROR(
      CheckPrefix("version.name", response.version().name(), "datasets/"));
  return std::move(*response.mutable_version());
}

absl::StatusOr<v1::DatasetVersion> TrainingClient::GetDatasetVersion(
    const std::string& name) {
  v1::GetDatasetVersionRequest request;
  request.set_name(name);
  TACTUS_ASSIGN_OR_RETURN(
      v1::GetDatasetVersionResponse response,
      Call(*this, *training_, &v1::TrainingService::Stub::GetDatasetVersion,
           request, "GetDatasetVersion", timeout()));
  const std::string& got = response.version().name();
  if (got != name && !absl::StartsWith(got, name + "/versions/")) {
    return InvalidResponse("version.name", Quoted(got),
                           absl::StrCat("a version of ", Quoted(name)));
  }
  return std::move(*response.mutable_version());
}

absl::StatusOr<std::vector<v1::TrialInfo>> TrainingClient::ListTrials(
    v1::ListTrialsRequest filter) {
  std::vector<v1::TrialInfo> trials;
  TACTUS_RETURN_IF_ERROR(EachPage(
      std::move(filter),
      [&](const v1::ListTrialsRequest& request) {
        return Call(*this, *training_, &v1::TrainingService::Stub::ListTrials,
                    request, "ListTrials", timeout());
      },
      [&](v1::ListTrialsResponse& response) {
        MoveAll(*response.mutable_trials(), &trials);
        return true;
      }));
  return trials;
}

absl::StatusOr<v1::CreateUploadResponse> TrainingClient::CreateUpload(
    const v1::CreateUploadRequest& request) {
  TACTUS_ASSIGN_OR_RETURN(
      v1::CreateUploadResponse response,
      Call(*this, *training_, &v1::TrainingService::Stub::CreateUpload, request,
           "CreateUpload", timeout()));
  TACTUS_RETURN_IF_ERROR(CheckPrefix("upload", response.upload(), "uploads/"));
  if (response.committed_size() < 0) {
    return InvalidResponse("committed_size", response.committed_size(),
                           "0 or more");
  }
  return response;
}

absl::StatusOr<v1::QueryWriteStatusResponse> TrainingClient::QueryWriteStatus(
    const std::string& upload) {
  v1::QueryWriteStatusRequest request;
  request.set_upload(upload);
  return Call(*this, *training_, &v1::TrainingService::Stub::QueryWriteStatus,
              request, "QueryWriteStatus", timeout());
}

absl::StatusOr<v1::FinishUploadResponse> TrainingClient::FinishUpload(
    const v1::FinishUploadRequest& request) {
  TACTUS_ASSIGN_OR_RETURN(
      v1::FinishUploadResponse response,
      Call(*this, *training_, &v1::TrainingService::Stub::FinishUpload, request,
           "FinishUpload", long_timeout()));
  TACTUS_RETURN_IF_ERROR(
      CheckPrefix("version.name", response.version().name(), "datasets/"));
  return response;
}

absl::StatusOr<v1::Operation> TrainingClient::TrainModel(
    const v1::TrainModelRequest& request) {
  TACTUS_ASSIGN_OR_RETURN(
      v1::TrainModelResponse response,
      Call(*this, *training_, &v1::TrainingService::Stub::TrainModel, request,
           "TrainModel", timeout()));
  return CheckOperation(std::move(*response.mutable_operation()),
                        request.validate_only());
}

absl::StatusOr<v1::Operation> TrainingClient::EvaluateModel(
    const v1::EvaluateModelRequest& request) {
  TACTUS_ASSIGN_OR_RETURN(
      v1::EvaluateModelResponse response,
      Call(*this, *training_, &v1::TrainingService::Stub::EvaluateModel,
           request, "EvaluateModel", timeout()));
  return CheckOperation(std::move(*response.mutable_operation()),
                        request.validate_only());
}

absl::StatusOr<v1::Operation> TrainingClient::GetOperation(
    const std::string& name) {
  v1::GetOperationRequest request;
  request.set_name(name);
  TACTUS_ASSIGN_OR_RETURN(
      v1::GetOperationResponse response,
      Call(*this, *operations_, &v1::OperationService::Stub::GetOperation,
           request, "GetOperation", timeout()));
  TACTUS_RETURN_IF_ERROR(
      CheckName("operation.name", response.operation().name(), name));
  return std::move(*response.mutable_operation());
}

absl::StatusOr<std::vector<v1::Operation>> TrainingClient::ListOperations(
    v1::Operation::State state, size_t limit) {
  std::vector<v1::Operation> operations;
  v1::ListOperationsRequest filter;
  filter.set_state(state);
  TACTUS_RETURN_IF_ERROR(EachPage(
      filter,
      [&](const v1::ListOperationsRequest& request) {
        return Call(*this, *operations_,
                    &v1::OperationService::Stub::ListOperations, request,
                    "ListOperations", timeout());
      },
      [&](v1::ListOperationsResponse& response) {
        MoveAll(*response.mutable_operations(), &operations);
        return operations.size() < limit;
      }));
  if (operations.size() > limit) operations.resize(limit);
  return operations;
}

absl::StatusOr<v1::Operation> TrainingClient::CancelOperation(
    const std::string& name) {
  v1::CancelOperationRequest request;
  request.set_name(name);
  TACTUS_ASSIGN_OR_RETURN(
      v1::CancelOperationResponse response,
      Call(*this, *operations_, &v1::OperationService::Stub::CancelOperation,
           request, "CancelOperation", timeout()));
  TACTUS_RETURN_IF_ERROR(
      CheckName("operation.name", response.operation().name(), name));
  return std::move(*response.mutable_operation());
}

absl::Status TrainingClient::DeleteOperation(const std::string& name) {
  v1::DeleteOperationRequest request;
  request.set_name(name);
  return Call(*this, *operations_, &v1::OperationService::Stub::DeleteOperation,
              request, "DeleteOperation", timeout())
      .status();
}

absl::StatusOr<std::vector<v1::ModelVersion>> TrainingClient::ListModelVersions(
    const std::string& model) {
  std::vector<v1::ModelVersion> versions;
  v1::ListModelVersionsRequest filter;
  filter.set_model(model);
  TACTUS_RETURN_IF_ERROR(EachPage(
      filter,
      [&](const v1::ListModelVersionsRequest& request) {
        return Call(*this, *models_, &v1::ModelService::Stub::ListModelVersions,
                    request, "ListModelVersions", timeout());
      },
      [&](v1::ListModelVersionsResponse& response) {
        MoveAll(*response.mutable_versions(), &versions);
        return true;
      }));
  return versions;
}

absl::StatusOr<v1::ModelVersion> TrainingClient::GetModelVersion(
    const std::string& name) {
  v1::GetModelVersionRequest request;
  request.set_name(name);
  TACTUS_ASSIGN_OR_RETURN(
      v1::GetModelVersionResponse response,
      Call(*this, *models_, &v1::ModelService::Stub::GetModelVersion, request,
           "GetModelVersion", timeout()));
  TACTUS_RETURN_IF_ERROR(
      CheckPrefix("version.name", response.version().name(), "models/"));
  return std::move(*response.mutable_version());
}

absl::Status TrainingClient::DeleteModelVersion(const std::string& name) {
  v1::DeleteModelVersionRequest request;
  request.set_name(name);
  return Call(*this, *models_, &v1::ModelService::Stub::DeleteModelVersion,
              request, "DeleteModelVersion", timeout())
      .status();
}

absl::StatusOr<std::string> TrainingClient::ExportModel(
    const std::string& name) {
  // The alias or the model may get another version between two calls.
  TACTUS_ASSIGN_OR_RETURN(const v1::ModelVersion version,
                          GetModelVersion(name));
  v1::ExportModelRequest request;
  request.set_name(version.name());
  const auto context = NewContext(long_timeout());
  const auto reader = models_->ExportModel(context.get(), request);
  std::string bundle;
  v1::ExportModelResponse response;
  while (reader->Read(&response)) {
    if (bundle.size() + response.data().size() > limits::kMaxBundleBytes) {
      context->TryCancel();
      return InvalidResponse(
          "size of the bundle",
          absl::StrCat("above ", limits::kMaxBundleBytes, " bytes"),
          absl::StrCat("at most ", limits::kMaxBundleBytes, " bytes"));
    }
    bundle.append(response.data());
  }
  if (const grpc::Status status = reader->Finish(); !status.ok()) {
    return ErrorOf(status, "ExportModel", long_timeout());
  }
  // The bundle ends with the SHA-256 of what is before it.
  for (const std::string& sha256 :
       {BundleSha256(bundle), Sha256Hex(BundleBody(bundle))}) {
    TACTUS_RETURN_IF_ERROR(
        CheckName("SHA-256 of the bundle", sha256, version.sha256()));
  }
  return bundle;
}

absl::StatusOr<v1::ModelVersion> TrainingClient::ImportModel(
    const std::string& model, absl::string_view bundle) {
  const auto context = NewContext(long_timeout());
  v1::ImportModelResponse response;
  const auto writer = models_->ImportModel(context.get(), &response);
  v1::ImportModelRequest request;
  request.set_model(model);
  for (size_t at = 0; at < bundle.size(); at += kChunkBytes) {
    request.set_data(std::string(bundle.substr(at, kChunkBytes)));
    // A failed write is explained by the status.
    if (!writer->Write(request)) break;
    request.clear_model();
  }
  writer->WritesDone();
  if (const grpc::Status status = writer->Finish(); !status.ok()) {
    return ErrorOf(status, "ImportModel", long_timeout());
  }
  TACTUS_RETURN_IF_ERROR(CheckName("SHA-256 of the imported bundle",
                                   response.version().sha256(),
                                   BundleSha256(bundle)));
  return std::move(*response.mutable_version());
}

absl::StatusOr<std::vector<v1::Alias>> TrainingClient::ListAliases() {
  TACTUS_ASSIGN_OR_RETURN(
      v1::ListAliasesResponse response,
      Call(*this, *models_, &v1::ModelService::Stub::ListAliases,
           v1::ListAliasesRequest(), "ListAliases", timeout()));
  std::vector<v1::Alias> aliases;
  MoveAll(*response.mutable_aliases(), &aliases);
  return aliases;
}

absl::StatusOr<v1::Alias> TrainingClient::UpdateAlias(
    const v1::UpdateAliasRequest& request) {
  TACTUS_ASSIGN_OR_RETURN(
      v1::UpdateAliasResponse response,
      Call(*this, *models_, &v1::ModelService::Stub::UpdateAlias, request,
           "UpdateAlias", timeout()));
  TACTUS_RETURN_IF_ERROR(
      CheckName("alias.name", response.alias().name(), request.name()));
  return std::move(*response.mutable_alias());
}

absl::StatusOr<v1::Operation> TrainingClient::PromoteModel(
    const v1::PromoteModelRequest& request) {
  TACTUS_ASSIGN_OR_RETURN(
      v1::PromoteModelResponse response,
      Call(*this, *models_, &v1::ModelService::Stub::PromoteModel, request,
           "PromoteModel", long_timeout()));
  return CheckOperation(std::move(*response.mutable_operation()), false);
}

absl::StatusOr<v1::Alias> TrainingClient::RollbackAlias(
    const std::string& name, const std::string& etag) {
  v1::RollbackAliasRequest request;
  request.set_name(name);
  request.set_etag(etag);
  TACTUS_ASSIGN_OR_RETURN(
      v1::RollbackAliasResponse response,
      Call(*this, *models_, &v1::ModelService::Stub::RollbackAlias, request,
           "RollbackAlias", timeout()));
  TACTUS_RETURN_IF_ERROR(
      CheckName("alias.name", response.alias().name(), name));
  return std::move(*response.mutable_alias());
}

absl::StatusOr<std::vector<v1::AliasChange>> TrainingClient::ListAliasHistory(
    const std::string& name) {
  v1::ListAliasHistoryRequest request;
  request.set_name(name);
  TACTUS_ASSIGN_OR_RETURN(
      v1::ListAliasHistoryResponse response,
      Call(*this, *models_, &v1::ModelService::Stub::ListAliasHistory, request,
           "ListAliasHistory", timeout()));
  std::vector<v1::AliasChange> changes;
  MoveAll(*response.mutable_changes(), &changes);
  return changes;
}

}  // namespace tactus::internal::client
