#include <algorithm>
#include <utility>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "server/records/spool.h"
#include "server/rpc/control_handlers.h"
#include "server/rpc/training_rpcs.h"
#include "tactus/v1/models.pb.h"

namespace tactus::internal::server {
namespace {

constexpr char kModelService[] = "/tactus.v1.ModelService/";

absl::Status ExportModel(TrainingBackend& backend,
                         const v1::ExportModelRequest& request,
                         ControlStream& stream) {
  TACTUS_ASSIGN_OR_RETURN(const v1::ModelVersion version,
                          backend.models().Get(request.name()));
  return backend.models().ReadBundle(version, [&](absl::string_view bundle) {
    v1::ExportModelResponse response;
    response.set_data(std::string(bundle));
    return WriteMessage(stream, response);
  });
}

absl::Status ImportModel(TrainingBackend& backend, ControlStream& stream) {
  std::string model;
  TACTUS_ASSIGN_OR_RETURN(const auto bundle, Spool::Create(backend.data()));
  while (true) {
    v1::ImportModelRequest request;
    bool more = false;
    TACTUS_RETURN_IF_ERROR(ReadMessage(stream, &request, &more));
    if (!more) break;
    if (model.empty()) model = request.model();
    if (!request.model().empty() && request.model() != model) {
      return InvalidName(request.model(), "the name in the first message");
    }
    const size_t size = bundle->size() + request.data().size();
    if (size > limits::kMaxBundleBytes) {
      return MessageTooLarge(size, limits::kMaxBundleBytes);
    }
    TACTUS_RETURN_IF_ERROR(bundle->Append(request.data()));
  }
  v1::ImportModelResponse response;
  TACTUS_ASSIGN_OR_RETURN(
      *response.mutable_version(),
      backend.models().Import(model, *bundle, stream.caller()));
  return WriteMessage(stream, response);
}

// A candidate that no gate must be passed for moves the alias now; a comparison
// is a job.
absl::StatusOr<v1::PromoteModelResponse> PromoteModel(
    TrainingBackend& backend, const v1::PromoteModelRequest& request,
    const Caller& caller) {
  const v1::PromoteSpec& spec = request.spec();
  v1::PromoteModelResponse response;
  v1::Operation& operation = *response.mutable_operation();
  TACTUS_ASSIGN_OR_RETURN(
      auto known, backend.operations().Find(request.request_id(), caller));
  if (known.has_value()) {
    operation = *std::move(known);
    return response;
  }
  operation.set_kind(v1::Operation::KIND_PROMOTE);
  *operation.mutable_promote() = spec;
  const auto alias = backend.models().GetAlias(spec.alias());
  const bool gated = alias.ok() && alias->has_gate();
  if (gated && !spec.force()) {
    TACTUS_ASSIGN_OR_RETURN(const v1::ModelVersion candidate,
                            backend.models().Get(spec.model_version()));
    TACTUS_RETURN_IF_ERROR(backend.models().Bundle(candidate).status());
    if (!spec.etag().empty() && spec.etag() != alias->etag()) {
      return EtagMismatch(spec.alias(), spec.etag(), alias->etag());
    }
    TACTUS_ASSIGN_OR_RETURN(
        operation,
        backend.operations().Create(operation, request.request_id(), caller));
    backend.jobs().Wake();
    return response;
  }
  operation.set_state(v1::Operation::STATE_SUCCEEDED);
  // In one transaction: the same request, sent twice at once, moves it once.
  TACTUS_ASSIGN_OR_RETURN(
      const v1::Alias moved,
      backend.models().Promote(spec, gated, caller, [&](Transaction& change) {
        return backend.operations().CreateIn(change, request.request_id(),
                                             caller, &operation);
      }));
  if (moved.lagging_replicas_size() > 0) {
    *operation.mutable_result()->mutable_lagging_replicas() =
        moved.lagging_replicas();
  }
  return response;
}

void AddVersions(TrainingBackend* backend, ControlService& control) {
  const auto add = [&](const std::string& method, Role role,
                       ControlService::Handler handler) {
    AddRpc(backend, control, kModelService + method, role, std::move(handler));
  };
  add("ListModelVersions", Role::kRobot,
      Unary<v1::ListModelVersionsRequest, v1::ListModelVersionsResponse>(
          [=](const auto& request,
              const Caller&) -> absl::StatusOr<v1::ListModelVersionsResponse> {
            TACTUS_ASSIGN_OR_RETURN(const int size,
                                    PageSize(request.page_size()));
            TACTUS_ASSIGN_OR_RETURN(
                auto page, backend->models().List(request.model(), size,
                                                  request.page_token()));
            v1::ListModelVersionsResponse response;
            for (auto& version : page.items) {
              *response.add_versions() = std::move(version);
            }
            response.set_next_page_token(page.next_token);
            return response;
          }));
  add("GetModelVersion", Role::kRobot,
      Unary<v1::GetModelVersionRequest, v1::GetModelVersionResponse>(
          [=](const auto& request,
              const Caller&) -> absl::StatusOr<v1::GetModelVersionResponse> {
            v1::GetModelVersionResponse response;
            TACTUS_ASSIGN_OR_RETURN(*response.mutable_version(),
                                    backend->models().Get(request.name()));
            return response;
          }));
  add("ExportModel", Role::kTrainer,
      ServerStream<v1::ExportModelRequest>(
          [=](const auto& request, ControlStream& stream) {
            return ExportModel(*backend, request, stream);
          }));
  add("ImportModel", Role::kTrainer,
      [=](ControlStream& stream) { return ImportModel(*backend, stream); });
  add("DeleteModelVersion", Role::kAdmin,
      Unary<v1::DeleteModelVersionRequest, v1::DeleteModelVersionResponse>(
          [=](const auto& request, const Caller& caller)
              -> absl::StatusOr<v1::DeleteModelVersionResponse> {
            TACTUS_RETURN_IF_ERROR(
                backend->models().Delete(request.name(), caller));
            return v1::DeleteModelVersionResponse();
          }));
}

void AddAliases(TrainingBackend* backend, ControlService& control) {
  const auto add = [&](const std::string& method, Role role,
                       ControlService::Handler handler) {
    AddRpc(backend, control, kModelService + method, role, std::move(handler));
  };
  add("ListAliases", Role::kRobot,
      Unary<v1::ListAliasesRequest, v1::ListAliasesResponse>(
          [=](const auto&,
              const Caller&) -> absl::StatusOr<v1::ListAliasesResponse> {
            TACTUS_ASSIGN_OR_RETURN(auto aliases, backend->models().Aliases());
            v1::ListAliasesResponse response;
            for (auto& alias : aliases) {
              *response.add_aliases() = std::move(alias);
            }
            return response;
          }));
  add("UpdateAlias", Role::kAdmin,
      Unary<v1::UpdateAliasRequest, v1::UpdateAliasResponse>(
          [=](const auto& request,
              const Caller& caller) -> absl::StatusOr<v1::UpdateAliasResponse> {
            v1::UpdateAliasResponse response;
            TACTUS_ASSIGN_OR_RETURN(
                *response.mutable_alias(),
                backend->models().UpdateAlias(request, caller));
            return response;
          }));
  add("PromoteModel", Role::kAdmin,
      Unary<v1::PromoteModelRequest, v1::PromoteModelResponse>(
          [=](const auto& request, const Caller& caller) {
            return PromoteModel(*backend, request, caller);
          }));
  add("RollbackAlias", Role::kAdmin,
      Unary<v1::RollbackAliasRequest, v1::RollbackAliasResponse>(
          [=](const auto& request, const Caller& caller)
              -> absl::StatusOr<v1::RollbackAliasResponse> {
            v1::RollbackAliasResponse response;
            TACTUS_ASSIGN_OR_RETURN(
                *response.mutable_alias(),
                backend->models().Rollback(request.name(), request.etag(),
                                           caller));
            return response;
          }));
  add("ListAliasHistory", Role::kRobot,
      Unary<v1::ListAliasHistoryRequest, v1::ListAliasHistoryResponse>(
          [=](const auto& request,
              const Caller&) -> absl::StatusOr<v1::ListAliasHistoryResponse> {
            TACTUS_ASSIGN_OR_RETURN(auto changes,
                                    backend->models().History(request.name()));
            v1::ListAliasHistoryResponse response;
            for (auto& change : changes) {
              *response.add_changes() = std::move(change);
            }
            return response;
          }));
}

}  // namespace

void AddModelRpcs(TrainingBackend* backend, ControlService& control) {
  AddVersions(backend, control);
  AddAliases(backend, control);
}

}  // namespace tactus::internal::server
