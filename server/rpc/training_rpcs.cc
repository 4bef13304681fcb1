#include "server/rpc/training_rpcs.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/train/folds.h"
#include "core/train/train_spec.h"
#include "server/names/resource_names.h"
#include "server/rpc/control_handlers.h"
#include "tactus/v1/training.pb.h"

namespace tactus::server {
namespace {

constexpr char kService[] = "/tactus.v1.TrainingService/";
// Bytes of an upload between two commits.
constexpr int64_t kCommitBytes = 64L * 1024 * 1024;

template <typename Message>
void SetPage(Page<typename Message::value_type>&& page, Message* items,
             std::string* next_token) {
  for (auto& item : page.items) *items->Add() = std::move(item);
  *next_token = std::move(page.next_token);
}

absl::Status CheckTrainSpec(TrainingBackend& backend,
                            const v1::TrainSpec& spec) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName model,
                          ParseName(spec.model(), "models"));
  if (model.version != 0) return InvalidName(spec.model(), "models/ID");
  if (const std::string fault =
          TextFault(spec.note(), limits::kMaxDescriptionBytes);
      !fault.empty()) {
    return InvalidConfig("note", Quoted(spec.note()), fault);
  }
  TACTUS_RETURN_IF_ERROR(OptionsOf(spec).status());
  return backend.datasets().Version(spec.dataset_version()).status();
}

absl::Status CheckEvaluateSpec(TrainingBackend& backend,
                               const v1::EvaluateSpec& spec) {
  TACTUS_RETURN_IF_ERROR(
      backend.datasets().Version(spec.dataset_version()).status());
  if (!spec.model_version().empty()) {
    TACTUS_ASSIGN_OR_RETURN(const v1::ModelVersion version,
                            backend.models().Get(spec.model_version()));
    return backend.models().Bundle(version).status();
  }
  TACTUS_RETURN_IF_ERROR(ParseProtocol(spec.protocol()).status());
  return OptionsOf(spec.train()).status();
}

// Fixes the versions that a request names, so that the job uses the same ones
// whenever it runs.
void Pin(TrainingBackend& backend, std::string* dataset_version) {
  *dataset_version = backend.datasets().Version(*dataset_version)->name();
}

absl::Status WriteUpload(TrainingBackend& backend, ControlStream& stream) {
  v1::WriteUploadRequest request;
  bool more = false;
  TACTUS_RETURN_IF_ERROR(ReadMessage(stream, &request, &more));
  if (!more) return EmptyRequest();
  const std::string name = request.upload();
  TACTUS_ASSIGN_OR_RETURN(const auto writer, backend.uploads().Write(name));
  while (more) {
    if (!request.upload().empty() && request.upload() != name) {
      return InvalidName(request.upload(), "the name in the first message");
    }
    const absl::Status status = writer->Append(
        request.write_offset(), request.data(), request.crc32c());
    if (!status.ok()) {
      // What came before it is kept.
      writer->Commit().IgnoreError();
      return status;
    }
    if (writer->uncommitted() >= kCommitBytes) {
      TACTUS_RETURN_IF_ERROR(writer->Commit());
    }
    const absl::Status read = ReadMessage(stream, &request, &more);
    if (!read.ok()) {
      writer->Commit().IgnoreError();
      return read;
    }
  }
  TACTUS_RETURN_IF_ERROR(writer->Commit());
  v1::WriteUploadResponse response;
  response.set_committed_size(writer->committed_size());
  return WriteMessage(stream, response);
}

absl::Status DownloadTrials(TrainingBackend& backend,
                            const v1::DownloadTrialsRequest& request,
                            ControlStream& stream) {
  TACTUS_ASSIGN_OR_RETURN(const auto version, backend.datasets().Version(
                                                  request.dataset_version()));
  TACTUS_ASSIGN_OR_RETURN(const auto trials,
                          backend.datasets().Trials(version));
  v1::DownloadTrialsResponse response;
  std::string& data = *response.mutable_data();
  for (const v1::TrialInfo& trial : trials) {
    TACTUS_ASSIGN_OR_RETURN(const std::string record,
                            backend.data().blobs().Read(
                                trial.sha256(), limits::kMaxTrialRecordBytes));
    const auto length = static_cast<uint32_t>(record.size());
    char head[sizeof length];
    std::memcpy(head, &length, sizeof length);
    data.append(head, sizeof head);
    size_t done = 0;
    while (done < record.size()) {
      const size_t part =
          std::min(record.size() - done, limits::kMaxChunkBytes - data.size());
      data.append(record, done, part);
      done += part;
      if (data.size() < limits::kMaxChunkBytes) continue;
      TACTUS_RETURN_IF_ERROR(WriteMessage(stream, response));
      data.clear();
    }
    // There is always room for the next length.
    if (data.size() + sizeof head > limits::kMaxChunkBytes) {
      TACTUS_RETURN_IF_ERROR(WriteMessage(stream, response));
      data.clear();
    }
  }
  return data.empty() ? absl::OkStatus() : WriteMessage(stream, response);
}

absl::StatusOr<v1::ListTrialsResponse> ListTrials(
    TrainingBackend& backend, const v1::ListTrialsRequest& request) {
  TACTUS_ASSIGN_OR_RETURN(const int size, PageSize(request.page_size()));
  TACTUS_ASSIGN_OR_RETURN(const auto version, backend.datasets().Version(
                                                  request.dataset_version()));
  TACTUS_ASSIGN_OR_RETURN(auto trials, backend.datasets().Trials(version));
  const auto key = [](const v1::TrialInfo& trial) {
    return absl::StrCat(trial.id(), "/", trial.sha256());
  };
  v1::ListTrialsResponse response;
  bool behind = request.page_token().empty();
  for (v1::TrialInfo& trial : trials) {
    if (!behind) {
      behind = key(trial) == request.page_token();
      continue;
    }
    if ((!request.label().empty() && trial.label() != request.label()) ||
        (!request.condition().empty() &&
         trial.condition() != request.condition()) ||
        (!request.material().empty() &&
         trial.material() != request.material())) {
      continue;
    }
    if (response.trials_size() == size) {
      response.set_next_page_token(key(response.trials(size - 1)));
      break;
    }
    *response.add_trials() = std::move(trial);
  }
  if (!behind) {
    return InvalidConfig("page_token", Quoted(request.page_token()),
                         "the next_page_token of the page before");
  }
  return response;
}

void AddDatasets(TrainingBackend* backend, ControlService& control) {
  const auto add = [&](const std::string& method, Role role,
                       ControlService::Handler handler) {
    AddRpc(backend, control, kService + method, role, std::move(handler));
  };
  add("CreateDataset", Role::kTrainer,
      Unary<v1::CreateDatasetRequest, v1::CreateDatasetResponse>(
          [=](const auto& request, const Caller& caller)
              -> absl::StatusOr<v1::CreateDatasetResponse> {
            v1::CreateDatasetResponse response;
            TACTUS_ASSIGN_OR_RETURN(
                *response.mutable_dataset(),
                backend->datasets().Create(request.name(),
                                           request.description(), caller));
            return response;
          }));
  add("GetDataset", Role::kTrainer,
      Unary<v1::GetDatasetRequest, v1::GetDatasetResponse>(
          [=](const auto& request,
              const Caller&) -> absl::StatusOr<v1::GetDatasetResponse> {
            v1::GetDatasetResponse response;
            TACTUS_ASSIGN_OR_RETURN(*response.mutable_dataset(),
                                    backend->datasets().Get(request.name()));
            TACTUS_ASSIGN_OR_RETURN(
                auto versions, backend->datasets().Versions(request.name()));
            for (auto& version : versions) {
              *response.add_versions() = std::move(version);
            }
            return response;
          }));
  add("ListDatasets", Role::kTrainer,
      Unary<v1::ListDatasetsRequest, v1::ListDatasetsResponse>(
          [=](const auto& request,
              const Caller&) -> absl::StatusOr<v1::ListDatasetsResponse> {
            TACTUS_ASSIGN_OR_RETURN(const int size,
                                    PageSize(request.page_size()));
            TACTUS_ASSIGN_OR_RETURN(auto page, backend->datasets().List(
                                                   size, request.page_token()));
            v1::ListDatasetsResponse response;
            SetPage(std::move(page), response.mutable_datasets(),
                    response.mutable_next_page_token());
            return response;
          }));
  add("DeleteDataset", Role::kAdmin,
      Unary<v1::DeleteDatasetRequest, v1::DeleteDatasetResponse>(
          [=](const auto& request, const Caller& caller)
              -> absl::StatusOr<v1::DeleteDatasetResponse> {
            TACTUS_ASSIGN_OR_RETURN(
                const uint32_t removed,
                backend->datasets().Delete(request.name(), caller));
            v1::DeleteDatasetResponse response;
            response.set_removed_trials(removed);
            return response;
          }));
  add("GetDatasetVersion", Role::kTrainer,
      Unary<v1::GetDatasetVersionRequest, v1::GetDatasetVersionResponse>(
          [=](const auto& request,
              const Caller&) -> absl::StatusOr<v1::GetDatasetVersionResponse> {
            v1::GetDatasetVersionResponse response;
            TACTUS_ASSIGN_OR_RETURN(
                *response.mutable_version(),
                backend->datasets().Version(request.name()));
            return response;
          }));
  add("ListTrials", Role::kTrainer,
      Unary<v1::ListTrialsRequest, v1::ListTrialsResponse>(
          [=](const auto& request, const Caller&) {
            return ListTrials(*backend, request);
          }));
  add("DownloadTrials", Role::kTrainer,
      ServerStream<v1::DownloadTrialsRequest>(
          [=](const auto& request, ControlStream& stream) {
            return DownloadTrials(*backend, request, stream);
          }));
}

void AddUploads(TrainingBackend* backend, ControlService& control) {
  const auto add = [&](const std::string& method,
                       ControlService::Handler handler) {
    AddRpc(backend, control, kService + method, Role::kTrainer,
           std::move(handler));
  };
  add("CreateUpload",
      Unary<v1::CreateUploadRequest, v1::CreateUploadResponse>(
          [=](const auto& request, const Caller& caller)
              -> absl::StatusOr<v1::CreateUploadResponse> {
            TACTUS_ASSIGN_OR_RETURN(const v1::StoredUpload upload,
                                    backend->uploads().Create(
                                        request.dataset(), request.request_id(),
                                        request.replace(), caller));
            v1::CreateUploadResponse response;
            response.set_upload(upload.name());
            response.set_committed_size(upload.committed_size());
            return response;
          }));
  add("WriteUpload",
      [=](ControlStream& stream) { return WriteUpload(*backend, stream); });
  add("QueryWriteStatus",
      Unary<v1::QueryWriteStatusRequest, v1::QueryWriteStatusResponse>(
          [=](const auto& request,
              const Caller&) -> absl::StatusOr<v1::QueryWriteStatusResponse> {
            TACTUS_ASSIGN_OR_RETURN(const v1::StoredUpload upload,
                                    backend->uploads().Get(request.upload()));
            v1::QueryWriteStatusResponse response;
            response.set_committed_size(upload.committed_size());
            response.set_dataset_version(upload.dataset_version());
            return response;
          }));
  add("FinishUpload",
      Unary<v1::FinishUploadRequest, v1::FinishUploadResponse>(
          [=](const auto& request, const Caller& caller)
              -> absl::StatusOr<v1::FinishUploadResponse> {
            v1::FinishUploadResponse response;
            uint32_t known = 0;
            TACTUS_ASSIGN_OR_RETURN(
                *response.mutable_version(),
                backend->uploads().Finish(request.upload(), request.size(),
                                          request.crc32c(), caller, &known));
            response.set_known_trials(known);
            return response;
          }));
}

void AddJobs(TrainingBackend* backend, ControlService& control) {
  AddRpc(
      backend, control, absl::StrCat(kService, "TrainModel"), Role::kTrainer,
      Unary<v1::TrainModelRequest, v1::TrainModelResponse>(
          [=](const auto& request,
              const Caller& caller) -> absl::StatusOr<v1::TrainModelResponse> {
            TACTUS_RETURN_IF_ERROR(CheckTrainSpec(*backend, request.spec()));
            v1::TrainModelResponse response;
            v1::Operation& operation = *response.mutable_operation();
            operation.set_kind(v1::Operation::KIND_TRAIN);
            *operation.mutable_train() = request.spec();
            Pin(*backend, operation.mutable_train()->mutable_dataset_version());
            if (request.validate_only()) return response;
            TACTUS_ASSIGN_OR_RETURN(
                operation, backend->operations().Create(
                               operation, request.request_id(), caller));
            backend->jobs().Wake();
            return response;
          }));
  AddRpc(
      backend, control, absl::StrCat(kService, "EvaluateModel"), Role::kTrainer,
      Unary<v1::EvaluateModelRequest, v1::EvaluateModelResponse>(
          [=](const auto& request, const Caller& caller)
              -> absl::StatusOr<v1::EvaluateModelResponse> {
            TACTUS_RETURN_IF_ERROR(CheckEvaluateSpec(*backend, request.spec()));
            v1::EvaluateModelResponse response;
            v1::Operation& operation = *response.mutable_operation();
            operation.set_kind(v1::Operation::KIND_EVALUATE);
            *operation.mutable_evaluate() = request.spec();
            Pin(*backend,
                operation.mutable_evaluate()->mutable_dataset_version());
            if (request.validate_only()) return response;
            TACTUS_ASSIGN_OR_RETURN(
                operation, backend->operations().Create(
                               operation, request.request_id(), caller));
            backend->jobs().Wake();
            return response;
          }));
}

}  // namespace

void AddRpc(TrainingBackend* backend, ControlService& control,
            const std::string& method, Role role,
            ControlService::Handler handler) {
  if (backend == nullptr) {
    handler = [](ControlStream&) { return NoDataDirectory(); };
  }
  control.Add(method, role, std::move(handler));
}

void AddTrainingRpcs(TrainingBackend* backend, ControlService& control) {
  AddDatasets(backend, control);
  AddUploads(backend, control);
  AddJobs(backend, control);
}

}  // namespace tactus::server
