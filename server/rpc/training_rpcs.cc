#include "server/rpc/training_rpcs.h"

#include <string>
#include <utility>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/contacts/folds.h"
#include "core/eval/train_spec.h"
#include "server/names/resource_names.h"
#include "server/rpc/control_handlers.h"
#include "tactus/v1/training.pb.h"

namespace tactus::server {
namespace {

constexpr char kTrainingService[] = "/tactus.v1.TrainingService/";

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
  TACTUS_RETURN_IF_ERROR(CheckOptions(spec));
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
  return CheckOptions(spec.train());
}

// Fixes the versions that a request names, so that the job uses the same ones
// whenever it runs.
void Pin(TrainingBackend& backend, std::string* dataset_version) {
  *dataset_version = backend.datasets().Version(*dataset_version)->name();
}

void AddJobs(TrainingBackend* backend, ControlService& control) {
  AddRpc(
      backend, control, absl::StrCat(kTrainingService, "TrainModel"),
      Role::kTrainer,
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
      backend, control, absl::StrCat(kTrainingService, "EvaluateModel"),
      Role::kTrainer,
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
  AddDatasetRpcs(backend, control);
  AddUploadRpcs(backend, control);
  AddJobs(backend, control);
}

}  // namespace tactus::server
