#include "server/rpc/admin_rpcs.h"

#include <algorithm>
#include <utility>

#include "core/base/status_macros.h"
#include "core/base/version.h"
#include "core/store/disk_use.h"
#include "server/ops/clock.h"
#include "server/records/audit_log.h"
#include "server/rpc/control_handlers.h"
#include "server/rpc/training_rpcs.h"
#include "spdlog/spdlog.h"
#include "tactus/v1/admin.pb.h"

namespace tactus::internal::server {
namespace {

absl::Status FillReplicas(TrainingBackend& backend,
                          v1::GetServerInfoResponse& info) {
  if (backend.replica() == nullptr) return absl::OkStatus();
  TACTUS_ASSIGN_OR_RETURN(const auto replicas, backend.replica()->All());
  uint64_t newest = 0;
  for (const Replica::Seen& seen : replicas) {
    newest = std::max(newest, seen.about.served_change());
  }
  for (const Replica::Seen& seen : replicas) {
    const bool is_worker = seen.about.address().empty();
    v1::Replica& replica = *info.add_replicas();
    replica.set_name(seen.about.name());
    replica.set_host(seen.about.host());
    replica.set_address(seen.about.address());
    replica.set_version(seen.about.version());
    replica.set_start_time_ms(seen.about.start_time_ms());
    replica.set_is_this(seen.is_this);
    replica.set_alive(seen.alive);
    replica.set_up_to_date(is_worker || seen.about.served_change() == newest);
  }
  return absl::OkStatus();
}

constexpr char kAdminService[] = "/tactus.v1.AdminService/";

// What the catalogue and the disk say.
absl::Status DescribeData(TrainingBackend& backend,
                          v1::GetServerInfoResponse* info) {
  *info->mutable_data() = MeasureData(backend.data().folder());
  TACTUS_ASSIGN_OR_RETURN(const auto counts,
                          backend.operations().CountByState());
  for (const auto& [state, count] : counts) {
    v1::JobCount& jobs = *info->add_jobs();
    jobs.set_state(state);
    jobs.set_count(count);
  }
  const Quotas& quotas = backend.quotas();
  info->mutable_quotas()->set_stored_bytes(quotas.stored_bytes);
  info->mutable_quotas()->set_datasets(quotas.datasets);
  info->mutable_quotas()->set_queued_jobs(quotas.queued_jobs);
  info->mutable_quotas()->set_model_bytes(quotas.model_bytes);
  for (const std::string& failure : backend.failures()) {
    info->add_not_served(failure);
  }
  return FillReplicas(backend, *info);
}

absl::StatusOr<v1::ListAuditLogResponse> ListAuditLog(
    TrainingBackend& backend, const v1::ListAuditLogRequest& request) {
  TACTUS_ASSIGN_OR_RETURN(const int size, PageSize(request.page_size()));
  TACTUS_ASSIGN_OR_RETURN(
      auto page, ListAudit(backend.data().catalog(), size, request.page_token(),
                           {.resource_prefix = request.resource_prefix(),
                            .caller = request.caller()}));
  v1::ListAuditLogResponse response;
  for (auto& entry : page.items) *response.add_entries() = std::move(entry);
  response.set_next_page_token(page.next_token);
  return response;
}

absl::Status Drain(const AdminOptions& options, ControlStream& stream) {
  const Caller& caller = stream.caller();
  if (options.backend != nullptr) {
    TACTUS_RETURN_IF_ERROR(
        options.backend->data().catalog().Change([&](Transaction& change) {
          return Audit(change, caller, options.backend->now_ms(), "drain",
                       "server");
        }));
  }
  spdlog::info("{} ({}) drains the server", caller.name, caller.peer);
  v1::DrainResponse response;
  response.set_streams(static_cast<uint32_t>(options.streams()));
  response.set_grace_ms(options.drain_grace_ms);
  const absl::Status status = WriteMessage(stream, response);
  // Also if the caller is gone: the drain is recorded.
  options.drain();
  return status;
}

}  // namespace

void AddAdminRpcs(const AdminOptions& options, ControlService& control) {
  const std::string service = kAdminService;
  const int64_t start_ms = SystemNowMs();
  const int64_t start_ns = MonotonicNs();
  control.Add(
      service + "GetServerInfo", Role::kAdmin,
      Unary<v1::GetServerInfoRequest, v1::GetServerInfoResponse>(
          [=](const auto&, const Caller& caller)
              -> absl::StatusOr<v1::GetServerInfoResponse> {
            v1::GetServerInfoResponse info;
            info.mutable_version()->set_version(kVersion);
            info.mutable_version()->set_api("tactus.v1");
            info.set_start_time_ms(start_ms);
            info.set_time_ms(SystemNowMs());
            info.set_uptime_ms((MonotonicNs() - start_ns) / kNsPerMs);
            info.set_streams(static_cast<uint32_t>(options.streams()));
            info.set_max_streams(static_cast<uint32_t>(options.max_streams));
            info.set_caller(caller.name);
            info.mutable_quotas()->set_streams(options.max_streams_per_client);
            if (options.backend != nullptr) {
              TACTUS_RETURN_IF_ERROR(DescribeData(*options.backend, &info));
            }
            return info;
          }));
  AddRpc(options.backend, control, service + "ListAuditLog", Role::kAdmin,
         Unary<v1::ListAuditLogRequest, v1::ListAuditLogResponse>(
             [=](const auto& request, const Caller&) {
               return ListAuditLog(*options.backend, request);
             }));
  if (!options.drain) return;
  control.Add(
      service + "Drain", Role::kAdmin,
      ServerStream<v1::DrainRequest>([=](const auto&, ControlStream& stream) {
        return Drain(options, stream);
      }));
}

}  // namespace tactus::internal::server
