#include <algorithm>
#include <chrono>
#include <utility>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "server/rpc/control_handlers.h"
#include "server/rpc/training_rpcs.h"
#include "tactus/v1/operations.pb.h"

namespace tactus::internal::server {
namespace {

using std::chrono::milliseconds;

constexpr char kOperationService[] = "/tactus.v1.OperationService/";
constexpr int64_t kDefaultWaitMs = 30'000;
constexpr int64_t kMaxWaitMs = 60'000;
// How long a wait goes on before it looks whether its client is still there.
constexpr milliseconds kLook(500);

absl::Status Watch(TrainingBackend& backend,
                   const v1::WatchOperationRequest& request,
                   ControlStream& stream) {
  OperationStore::Cursor cursor;
  uint64_t sent = 0;
  while (!stream.IsCancelled()) {
    TACTUS_ASSIGN_OR_RETURN(auto update, backend.operations().WaitForChange(
                                             request.name(), &cursor, kLook));
    if (cursor.change == sent && update.points.empty()) continue;
    sent = cursor.change;
    v1::WatchOperationResponse response;
    for (auto& point : update.points) *response.add_points() = std::move(point);
    const bool ended = HasEnded(update.operation);
    *response.mutable_operation() = std::move(update.operation);
    TACTUS_RETURN_IF_ERROR(WriteMessage(stream, response));
    if (ended) return absl::OkStatus();
  }
  return Draining();
}

absl::Status Wait(TrainingBackend& backend,
                  const v1::WaitOperationRequest& request,
                  ControlStream& stream) {
  if (request.timeout_ms() < 0 || request.timeout_ms() > kMaxWaitMs) {
    return InvalidConfig("timeout_ms", request.timeout_ms(), "0 to 60000");
  }
  const auto end =
      std::chrono::steady_clock::now() +
      milliseconds(request.timeout_ms() == 0 ? kDefaultWaitMs
                                             : request.timeout_ms());
  OperationStore::Cursor cursor;
  v1::WaitOperationResponse response;
  do {
    TACTUS_ASSIGN_OR_RETURN(auto update, backend.operations().WaitForChange(
                                             request.name(), &cursor, kLook));
    *response.mutable_operation() = std::move(update.operation);
  } while (!HasEnded(response.operation()) && !stream.IsCancelled() &&
           std::chrono::steady_clock::now() < end);
  return WriteMessage(stream, response);
}

absl::Status ReadLog(TrainingBackend& backend,
                     const v1::ReadOperationLogRequest& request,
                     ControlStream& stream) {
  TACTUS_ASSIGN_OR_RETURN(const v1::StoredLog log,
                          backend.jobs().Log(request.name()));
  v1::ReadOperationLogResponse response;
  response.set_omitted_bytes(log.omitted_bytes());
  for (size_t done = 0; done < log.data().size();
       done += limits::kJobLogMessageBytes) {
    response.set_data(log.data().substr(done, limits::kJobLogMessageBytes));
    TACTUS_RETURN_IF_ERROR(WriteMessage(stream, response));
    response.Clear();
  }
  return absl::OkStatus();
}

}  // namespace

void AddOperationRpcs(TrainingBackend* backend, ControlService& control) {
  const auto add = [&](const std::string& method,
                       ControlService::Handler handler) {
    AddRpc(backend, control, kOperationService + method, Role::kTrainer,
           std::move(handler));
  };
  add("GetOperation",
      Unary<v1::GetOperationRequest, v1::GetOperationResponse>(
          [=](const auto& request,
              const Caller&) -> absl::StatusOr<v1::GetOperationResponse> {
            v1::GetOperationResponse response;
            TACTUS_ASSIGN_OR_RETURN(*response.mutable_operation(),
                                    backend->operations().Get(request.name()));
            return response;
          }));
  add("ListOperations",
      Unary<v1::ListOperationsRequest, v1::ListOperationsResponse>(
          [=](const auto& request,
              const Caller&) -> absl::StatusOr<v1::ListOperationsResponse> {
            TACTUS_ASSIGN_OR_RETURN(const int size,
                                    PageSize(request.page_size()));
            TACTUS_ASSIGN_OR_RETURN(
                auto page, backend->operations().List(
                               size, request.page_token(), request.state()));
            v1::ListOperationsResponse response;
            for (auto& operation : page.items) {
              *response.add_operations() = std::move(operation);
            }
            response.set_next_page_token(page.next_token);
            return response;
          }));
  add("WaitOperation", ServerStream<v1::WaitOperationRequest>(
                           [=](const auto& request, ControlStream& stream) {
                             return Wait(*backend, request, stream);
                           }));
  add("WatchOperation", ServerStream<v1::WatchOperationRequest>(
                            [=](const auto& request, ControlStream& stream) {
                              return Watch(*backend, request, stream);
                            }));
  add("ReadOperationLog", ServerStream<v1::ReadOperationLogRequest>(
                              [=](const auto& request, ControlStream& stream) {
                                return ReadLog(*backend, request, stream);
                              }));
  add("DeleteOperation",
      Unary<v1::DeleteOperationRequest, v1::DeleteOperationResponse>(
          [=](const auto& request, const Caller& caller)
              -> absl::StatusOr<v1::DeleteOperationResponse> {
            TACTUS_RETURN_IF_ERROR(
                backend->operations().Delete(request.name(), caller));
            return v1::DeleteOperationResponse();
          }));
  add("CancelOperation",
      Unary<v1::CancelOperationRequest, v1::CancelOperationResponse>(
          [=](const auto& request,
              const Caller&) -> absl::StatusOr<v1::CancelOperationResponse> {
            v1::CancelOperationResponse response;
            TACTUS_ASSIGN_OR_RETURN(*response.mutable_operation(),
                                    backend->jobs().Cancel(request.name()));
            return response;
          }));
}

}  // namespace tactus::internal::server
