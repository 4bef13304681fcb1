// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <memory>
#include <string>

#include "core/base/errors.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "grpcpp/server_builder.h"
#include "server/ops/arrival_gate.h"
#include "server/ops/authorizer.h"
#include "server/ops/client_streams.h"
#include "server/ops/guarded_credentials.h"
#include "server/ops/health_probe.h"
#include "server/ops/peer.h"
#include "server/ops/signals.h"
#include "server/ops/skip_totals.h"
#include "server/ops/stream_gate.h"
#include "server/ops/tls.h"
#include "server/registry/default_bundle.h"
#include "server/registry/model_registry.h"
#include "server/rpc/admin_rpcs.h"
#include "server/rpc/answer_pacing.h"
#include "server/rpc/call_queue.h"
#include "server/rpc/contact_call.h"
#include "server/rpc/contact_service.h"
#include "server/rpc/control_call.h"
#include "server/rpc/control_handlers.h"
#include "server/rpc/control_service.h"
#include "server/rpc/health_service.h"
#include "server/rpc/incoming_call.h"
#include "server/rpc/request_limits.h"
#include "server/rpc/training_rpcs.h"
#include "server/rpc/trial_call.h"
#include "server/session/fitting_models.h"
#include "server/session/model_source.h"
#include "server/session/request_parser.h"
#include "server/session/response_queue.h"
#include "server/session/stream_session.h"
#include "server/session/trial_session.h"
#include "server/tactus_server.h"
#include "server/trainer/yield_timer.h"
#include "spdlog/spdlog.h"
#include "tactus/v1/models.pb.h"
#include "tactus/v1/training.pb.h"

namespace tactus::internal::server::examples {

using Bytes = google::protobuf::io::ZeroCopyInputStream;

void Use();
void Write(const v1::ClassifyContactResponse& response);

static void YieldTimerExample() {
#include "server/trainer/yield_timer.h.inc"
}

static void HealthProbeExample(const std::shared_ptr<grpc::Channel>& channel) {
#include "server/ops/health_probe.h.inc"
}

void Reload();

static void SignalsExample() {
#include "server/ops/signals.h.inc"
}

static absl::Status AuthorizerExample(TactusServer::Options& options) {
#include "server/ops/authorizer.h.inc"
  return absl::OkStatus();
}

static absl::Status FittingModelsExample(StreamSettings& settings,
                                         const ModelSource& models) {
#include "server/session/fitting_models.h.inc"
  return absl::OkStatus();
}

static void SkipTotalsExample(SkipTotals& totals,
                              const StreamSession& session) {
#include "server/ops/skip_totals.h.inc"
}

void Refuse();

static void ArrivalGateExample(ArrivalGate& gate) {
#include "server/ops/arrival_gate.h.inc"
}

static void GuardedCredentialsExample(ArrivalGate& gate,
                                      grpc::ServerBuilder& builder,
                                      const std::string& address) {
  int port = 0;
#include "server/ops/guarded_credentials.h.inc"
}

static void PeerExample(StreamGate& gate, const grpc::ServerContext& context) {
#include "server/ops/peer.h.inc"
}

static void IncomingCallExample(CallQueue* queue, StreamGate& gate) {
#include "server/rpc/incoming_call.h.inc"
}

static void ControlCallExample(ControlService* service, CallQueue* queue) {
#include "server/rpc/control_call.h.inc"
}

static void ControlServiceExample(const ControlService::Authorize& authorize,
                                  ServerMetrics& metrics,
                                  const ControlService::Handler& handler,
                                  grpc::ServerBuilder& builder,
                                  CallQueue& queue) {
#include "server/rpc/control_service.h.inc"
}

static void ControlHandlersExample(
    ControlService& control,
    std::function<absl::StatusOr<v1::ListAliasesResponse>(
        const v1::ListAliasesRequest&, const Caller&)>
        answer) {
#include "server/rpc/control_handlers.h.inc"
}

static void TrainingRpcsExample(TrainingBackend* backend,
                                ControlService& control) {
#include "server/rpc/training_rpcs.h.inc"
}

static absl::Status StreamGateExample(const std::string& peer,
                                      uint64_t frames) {
#include "server/ops/stream_gate.h.inc"
  return absl::OkStatus();
}

static absl::Status ClientStreamsExample(const void* call,
                                         const Caller& caller) {
#include "server/ops/client_streams.h.inc"
  return absl::OkStatus();
}

static void AdminRpcsExample(TrainingBackend* backend, const StreamGate& gate,
                             ControlService& control) {
#include "server/rpc/admin_rpcs.h.inc"
}

static absl::Status TlsExample(TactusServer::Options& options) {
#include "server/ops/tls.h.inc"
  return absl::OkStatus();
}

static void ModelSourceExample(const ModelSource& models,
                               const std::string& client_id) {
#include "server/session/model_source.h.inc"
}

static absl::Status ModelRegistryExample() {
#include "server/registry/model_registry.h.inc"
  return absl::OkStatus();
}

void StartRead();

static void AnswerPacingExample(bool reading, bool more_follow,
                                CallQueue* queue, CallEvent& nothing_more,
                                grpc::WriteOptions& options) {
#include "server/rpc/answer_pacing.h.inc"
}

static void CallQueueExample(grpc::ServerBuilder& builder,
                             ArrivalGate& arrivals,
                             std::chrono::system_clock::time_point deadline) {
#include "server/rpc/call_queue.h.inc"
}

static void ContactCallExample(RawContactService* service, CallQueue* queue,
                               ContactCall::Delegate* delegate) {
#include "server/rpc/contact_call.h.inc"
}

static void TrialCallExample(RawContactService* service, CallQueue* queue,
                             TrialCall::Delegate* delegate) {
#include "server/rpc/trial_call.h.inc"
}

static void ContactServiceExample(grpc::ServerBuilder& builder,
                                  ContactService& service, CallQueue& queue) {
#include "server/rpc/contact_service.h.inc"
}

static void HealthServiceExample(grpc::ServerBuilder& builder,
                                 HealthService& health, CallQueue& queue) {
#include "server/rpc/health_service.h.inc"
}

static absl::Status ServerExample(const ModelRegistry& registry) {
#include "server/tactus_server.h.inc"
  return absl::OkStatus();
}

static absl::Status RequestParserExample(Bytes& bytes, size_t size) {
  v1::ClassifyContactRequest request;
#include "server/session/request_parser.h.inc"
  return absl::OkStatus();
}

static absl::Status RequestLimitsExample(size_t size) {
#include "server/rpc/request_limits.h.inc"
  return absl::OkStatus();
}

void WriteInto(v1::Answer* posterior);

static void ResponseQueueExample(ResponseQueue& queue, bool has_events,
                                 int64_t elapsed_ns, int64_t now_ns) {
#include "server/session/response_queue.h.inc"
}

void Finish(const absl::Status& status);

static void StreamSessionExample(const ModelSource* models, Bytes& bytes,
                                 size_t size, int64_t start_ns,
                                 int64_t now_ns) {
  v1::ClassifyContactRequest request;
#include "server/session/stream_session.h.inc"
}

void Send(const v1::ClassifyTrialResponse& response);

static void TrialSessionExample(const ModelSource* models,
                                const std::string& bytes) {
  v1::ClassifyContactRequest request;
#include "server/session/trial_session.h.inc"
}

}  // namespace tactus::internal::server::examples
