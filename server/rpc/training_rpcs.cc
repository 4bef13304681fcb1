#include "server/rpc/training_rpcs.h"

#include <string>
#include <utility>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/contacts/class_counts.h"
#include "core/contacts/folds.h"
#include "core/train/train_spec.h"
#include "server/names/resource_names.h"
#include "server/records/pinned_version.h"
#include "server/rpc/control_handlers.h"
#include "tactus/v1/training.pb.h"

namespace tactus::internal::server {
namespace {

constexpr char kTrainingService[] = "/tactus.v1.TrainingService/";

// Fixes the dataset version that a request names, so that the job uses the same
// one whenever it runs. Returns what is known of it.
absl::StatusOr<v1::DatasetVersion> PinDataset(TrainingBackend& backend,
                                              std::string* name) {
  TACTUS_ASSIGN_OR_RETURN(
      const auto version,
      PinnedVersion::Find(backend.data(), backend.datasets(), *name));
  *name = version.name();
  return version.info();
}

// Finds what no fit can succeed with before a job is made. Trials that the skin
// never felt are known only to the job.
absl::Status CheckLabels(const v1::DatasetVersion& version, bool skip_small) {
  ClassCounts counts;
  for (const auto& [label, trials] : version.labels()) {
    counts[label] = static_cast<int>(trials);
  }
  if (skip_small) {
    for (const std::string& label : SmallClasses(counts)) counts.erase(label);
  }
  return Annotate(CheckClasses(counts, "trials"), version.name());
}

// `spec` with its dataset version fixed, or what is wrong with it.
absl::StatusOr<v1::TrainSpec> Checked(TrainingBackend& backend,
                                      v1::TrainSpec spec) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName model,
                          ParseName(spec.model(), "models"));
  if (model.version != 0) return InvalidName(spec.model(), "models/ID");
  if (const std::string fault =
          TextFault(spec.note(), limits::kMaxDescriptionBytes);
      !fault.empty()) {
    return InvalidConfig("note", Quoted(spec.note()), fault);
  }
  TACTUS_RETURN_IF_ERROR(CheckOptions(spec));
  TACTUS_ASSIGN_OR_RETURN(const v1::DatasetVersion dataset,
                          PinDataset(backend, spec.mutable_dataset_version()));
  TACTUS_RETURN_IF_ERROR(CheckLabels(dataset, spec.skip_unusable()));
  return spec;
}

// `spec` with its dataset version and its model version fixed, or what is wrong
// with it.
absl::StatusOr<v1::EvaluateSpec> Checked(TrainingBackend& backend,
                                         v1::EvaluateSpec spec) {
  TACTUS_ASSIGN_OR_RETURN(const v1::DatasetVersion dataset,
                          PinDataset(backend, spec.mutable_dataset_version()));
  if (!spec.model_version().empty()) {
    TACTUS_ASSIGN_OR_RETURN(const v1::ModelVersion version,
                            backend.models().Get(spec.model_version()));
    TACTUS_RETURN_IF_ERROR(backend.models().Bundle(version).status());
    spec.set_model_version(version.name());
    return spec;
  }
  TACTUS_RETURN_IF_ERROR(ParseProtocol(spec.protocol()).status());
  TACTUS_RETURN_IF_ERROR(CheckOptions(spec.train()));
  TACTUS_RETURN_IF_ERROR(CheckLabels(dataset, spec.train().skip_unusable()));
  return spec;
}

void AddJobs(TrainingBackend* backend, ControlService& control) {
  AddRpc(
      backend, control, absl::StrCat(kTrainingService, "TrainModel"),
      Role::kTrainer,
      Unary<v1::TrainModelRequest, v1::TrainModelResponse>(
          [=](const auto& request,
              const Caller& caller) -> absl::StatusOr<v1::TrainModelResponse> {
            v1::TrainModelResponse response;
            v1::Operation& operation = *response.mutable_operation();
            operation.set_kind(v1::Operation::KIND_TRAIN);
            TACTUS_ASSIGN_OR_RETURN(*operation.mutable_train(),
                                    Checked(*backend, request.spec()));
            if (request.validate_only()) return response;
            TACTUS_ASSIGN_OR_RETURN(
                operation, backend->operations().Create(
                               operation, request.request_id(), caller));
            backend->jobs().Wake();
            return response;
          }));
  AddRpc(backend, control, absl::StrCat(kTrainingService, "EvaluateModel"),
         Role::kTrainer,
         Unary<v1::EvaluateModelRequest, v1::EvaluateModelResponse>(
             [=](const auto& request, const Caller& caller)
                 -> absl::StatusOr<v1::EvaluateModelResponse> {
               v1::EvaluateModelResponse response;
               v1::Operation& operation = *response.mutable_operation();
               operation.set_kind(v1::Operation::KIND_EVALUATE);
               TACTUS_ASSIGN_OR_RETURN(*operation.mutable_evaluate(),
                                       Checked(*backend, request.spec()));
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

}  // namespace tactus::internal::server
