// File: fake_model_service.h
//
// The ModelService of a FakeTrainingServer.
#pragma once

#include <string>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/bundle/bundle.h"
#include "server/rpc/status.h"
#include "tests/client/training/fake_state.h"

namespace tactus::internal::client::testing {

class FakeModelService : public v1::ModelService::Service {
 public:
  explicit FakeModelService(FakeState* state) : state_(*state) {}

  grpc::Status ListModelVersions(
      grpc::ServerContext*, const v1::ListModelVersionsRequest* request,
      v1::ListModelVersionsResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    for (const auto& [version, bundle] : state_.models) {
      if (absl::StartsWith(version.name(), request->model())) {
        *response->add_versions() = version;
      }
    }
    return state_.End(*response);
  }

  grpc::Status GetModelVersion(grpc::ServerContext*,
                               const v1::GetModelVersionRequest* request,
                               v1::GetModelVersionResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    const auto* found = Find(request->name());
    if (found == nullptr)
      return server::ToGrpcStatus(ModelNotFound(request->name()));
    *response->mutable_version() = found->first;
    return state_.End(*response);
  }

  grpc::Status ExportModel(
      grpc::ServerContext*, const v1::ExportModelRequest* request,
      grpc::ServerWriter<v1::ExportModelResponse>* writer) override {
    const std::lock_guard lock(state_.mutex);
    const auto* found = Find(request->name());
    if (found == nullptr)
      return server::ToGrpcStatus(ModelNotFound(request->name()));
    for (size_t at = 0; at < found->second.size(); at += 100) {
      v1::ExportModelResponse response;
      response.set_data(found->second.substr(at, 100));
      state_.End(response);
      writer->Write(response);
    }
    return grpc::Status::OK;
  }

  grpc::Status ImportModel(grpc::ServerContext*,
                           grpc::ServerReader<v1::ImportModelRequest>* reader,
                           v1::ImportModelResponse* response) override {
    std::string model;
    std::string bundle;
    v1::ImportModelRequest request;
    while (reader->Read(&request)) {
      if (!request.model().empty()) model = request.model();
      bundle += request.data();
    }
    const std::lock_guard lock(state_.mutex);
    v1::ModelVersion& version = *response->mutable_version();
    version.set_name(model + "/versions/1");
    version.set_sha256(BundleSha256(bundle));
    version.set_bytes(static_cast<int64_t>(bundle.size()));
    state_.models.emplace_back(version, bundle);
    return state_.End(*response);
  }

  grpc::Status DeleteModelVersion(grpc::ServerContext*,
                                  const v1::DeleteModelVersionRequest* request,
                                  v1::DeleteModelVersionResponse*) override {
    const std::lock_guard lock(state_.mutex);
    for (const auto& [name, alias] : state_.aliases) {
      if (alias.model_version() == request->name()) {
        return server::ToGrpcStatus(ModelInUse(request->name(), name));
      }
    }
    const auto removed = std::erase_if(state_.models, [&](const auto& entry) {
      return entry.first.name() == request->name();
    });
    return removed == 1 ? grpc::Status::OK
                        : server::ToGrpcStatus(ModelNotFound(request->name()));
  }

  grpc::Status ListAliases(grpc::ServerContext*, const v1::ListAliasesRequest*,
                           v1::ListAliasesResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    for (const auto& [name, alias] : state_.aliases) {
      *response->add_aliases() = alias;
    }
    return state_.End(*response);
  }

  grpc::Status UpdateAlias(grpc::ServerContext*,
                           const v1::UpdateAliasRequest* request,
                           v1::UpdateAliasResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    state_.update = *request;
    v1::Alias& alias = state_.aliases[request->name()];
    alias.set_name(request->name());
    alias.clear_canary();
    alias.clear_gate();
    if (request->has_canary()) *alias.mutable_canary() = request->canary();
    if (request->has_gate()) *alias.mutable_gate() = request->gate();
    *response->mutable_alias() = alias;
    return state_.End(*response);
  }

  grpc::Status PromoteModel(grpc::ServerContext*,
                            const v1::PromoteModelRequest* request,
                            v1::PromoteModelResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    state_.promotion = *request;
    const v1::PromoteSpec& spec = request->spec();
    v1::Operation operation = state_.new_job;
    operation.set_name(absl::StrCat("operations/", state_.jobs.size() + 1));
    operation.set_kind(v1::Operation::KIND_PROMOTE);
    *operation.mutable_promote() = spec;
    if (operation.state() == v1::Operation::STATE_SUCCEEDED) {
      v1::Alias& alias = state_.aliases[spec.alias()];
      alias.set_name(spec.alias());
      alias.set_previous_version(alias.model_version());
      alias.set_model_version(spec.model_version());
    }
    state_.jobs[operation.name()].operation = operation;
    *response->mutable_operation() = operation;
    return state_.End(*response);
  }

  grpc::Status RollbackAlias(grpc::ServerContext*,
                             const v1::RollbackAliasRequest* request,
                             v1::RollbackAliasResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    const auto found = state_.aliases.find(request->name());
    if (found == state_.aliases.end()) {
      return server::ToGrpcStatus(
          NoSuch(v1::ERROR_REASON_ALIAS_NOT_FOUND, "alias", request->name(),
                 "trainctl models alias shows those that do"));
    }
    v1::Alias& alias = found->second;
    if (alias.previous_version().empty()) {
      return server::ToGrpcStatus(NothingToRollBack(request->name()));
    }
    const std::string current = alias.model_version();
    alias.set_model_version(alias.previous_version());
    alias.set_previous_version(current);
    *response->mutable_alias() = alias;
    return state_.End(*response);
  }

  grpc::Status ListAliasHistory(
      grpc::ServerContext*, const v1::ListAliasHistoryRequest* request,
      v1::ListAliasHistoryResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    const auto found = state_.aliases.find(request->name());
    if (found == state_.aliases.end()) {
      return server::ToGrpcStatus(
          NoSuch(v1::ERROR_REASON_ALIAS_NOT_FOUND, "alias", request->name(),
                 "trainctl models alias shows those that do"));
    }
    v1::AliasChange& change = *response->add_changes();
    change.set_model_version(found->second.model_version());
    change.set_time_ms(1'700'000'000'000);
    change.set_requester("anna");
    change.set_forced(true);
    return state_.End(*response);
  }

 private:
  // Null if there is none.
  const std::pair<v1::ModelVersion, std::string>* Find(
      const std::string& name) {
    const auto alias = state_.aliases.find(name);
    const std::string& wanted =
        alias == state_.aliases.end() ? name : alias->second.model_version();
    for (const auto& entry : state_.models) {
      if (entry.first.name() == wanted ||
          absl::StartsWith(entry.first.name(), wanted + "/")) {
        return &entry;
      }
    }
    return nullptr;
  }

  FakeState& state_;
};

}  // namespace tactus::internal::client::testing
