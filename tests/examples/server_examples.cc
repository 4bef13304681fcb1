// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
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
#include "server/session/frame_decoder.h"
#include "server/session/model_source.h"
#include "server/session/posterior_writer.h"
#include "server/session/request_parser.h"
#include "server/session/response_queue.h"
#include "server/session/stream_session.h"
#include "server/session/stream_settings.h"
#include "server/session/trial_session.h"
#include "server/tactus_server.h"
#include "server/trainer/yield_timer.h"
#include "spdlog/spdlog.h"
#include "tactus/v1/models.pb.h"
#include "tactus/v1/training.pb.h"

namespace tactus::server::examples {

using Bytes = google::protobuf::io::ZeroCopyInputStream;

void Use();
void Write(const v1::ClassifyContactResponse& response);

void YieldTimerExample() {
  YieldAtIntervals();
  const ParallelFor threads = Yielding(OnThreads(2));
}

void HealthProbeExample(const std::shared_ptr<grpc::Channel>& channel) {
  auto serving = ProbeHealth(channel, "", std::chrono::seconds(2));
}

void Reload();

void SignalsExample() {
  StopSignals signals;  // in main, before any thread starts
  // ... start the server ...
  signals.Wait();  // the first signal
  // ... stop in good order; a second signal ends the process at once ...
  signals.Wait([&] { Reload(); });  // SIGHUP reloads instead
}

absl::Status AuthorizerExample(TactusServer::Options& options) {
  TACTUS_ASSIGN_OR_RETURN(auto authorizer, Authorizer::Open("tokens"));
  options.authorizer = authorizer.get();
  // ... after a change of the file ...
  absl::Status status = authorizer->Reload();
  return absl::OkStatus();
}

absl::Status FittingModelsExample(const StreamSettings& settings,
                                  const PinnedModel& pinned,
                                  const ModelSource& models) {
  const absl::Status fits =
      ContactPipeline::Check(settings.layout, *pinned.model, settings.pipeline);
  if (!fits.ok()) return NameFittingModels(fits, pinned, settings, models);
  return absl::OkStatus();
}

void SkipTotalsExample(SkipTotals& totals, const StreamSession& session) {
  totals.Add(session.skipped());
  spdlog::info("skipped {}", totals.ToString());
}

void Refuse();

void ArrivalGateExample(ArrivalGate& gate) {
  if (!gate.TryEnter(MonotonicNs())) Refuse();
  ArrivalGate::Request request(&gate);  // asks gRPC for the next call
  request.Arrive();                     // a call has come
  request.Admit();                      // another limit counts it now
}

void GuardedCredentialsExample(ArrivalGate& gate, grpc::ServerBuilder& builder,
                               const std::string& address) {
  int port = 0;
  CallRefuser refuser(&gate);
  const Guards guards = {&gate, &refuser, false};
  builder.AddListeningPort(
      address, Guard(grpc::InsecureServerCredentials(), guards), &port);
}

void PeerExample(StreamGate& gate, const grpc::ServerContext& context) {
  const absl::Status status = gate.Enter(PeerOf(context.peer()));
}

void IncomingCallExample(CallQueue* queue, StreamGate& gate) {
  IncomingCall call(queue);  // before gRPC is asked for the next call
  absl::Status status =      // a call has come
      call.Arrive([&] { return gate.Enter(call.peer()); });
}

void ControlCallExample(ControlService* service, CallQueue* queue) {
  new ControlCall(service, queue);  // awaits a call
}

void ControlServiceExample(const ControlService::Authorize& authorize,
                           const ControlService::Handler& handler,
                           grpc::ServerBuilder& builder, CallQueue& queue) {
  ControlService control(authorize);
  control.Add("/tactus.v1.ModelService/ListAliases", Role::kRobot, handler);
  builder.RegisterAsyncGenericService(control.generic());
  control.Serve(&queue);
}

void ControlHandlersExample(
    ControlService& control,
    std::function<absl::StatusOr<v1::ListAliasesResponse>(
        const v1::ListAliasesRequest&, const Caller&)>
        answer) {
  control.Add("/tactus.v1.ModelService/ListAliases", Role::kRobot,
              Unary<v1::ListAliasesRequest, v1::ListAliasesResponse>(answer));
}

void TrainingRpcsExample(TrainingBackend* backend, ControlService& control) {
  AddTrainingRpcs(backend, control);
  AddOperationRpcs(backend, control);
  AddModelRpcs(backend, control);
}

absl::Status StreamGateExample(const std::string& peer, uint64_t frames) {
  StreamGate gate("streams", {.all = 2000, .per_peer = 1000});
  TACTUS_RETURN_IF_ERROR(gate.Enter(peer));
  // ... serve the stream ...
  gate.Leave(peer, frames);
  return absl::OkStatus();
}

absl::Status ClientStreamsExample(const void* call, const Caller& caller) {
  ClientStreams clients(100);
  TACTUS_RETURN_IF_ERROR(clients.Enter(call, caller.name));
  // ... serve the stream ...
  clients.Leave(call);
  return absl::OkStatus();
}

void AdminRpcsExample(TrainingBackend* backend, const StreamGate& gate,
                      ControlService& control) {
  AddAdminRpcs({.backend = backend,
                .streams = [&] { return gate.live(); },
                .drain = [] { kill(getpid(), SIGTERM); }},
               control);
}

absl::Status TlsExample(TactusServer::Options& options) {
  TACTUS_ASSIGN_OR_RETURN(options.tls, ReadTlsIdentity("s.crt", "s.key"));
  return absl::OkStatus();
}

void ModelSourceExample(const ModelSource& models,
                        const std::string& client_id) {
  auto pinned = models.Find("default", client_id);
}

void PosteriorWriterExample(PosteriorWriter& writer, ContactPipeline& pipeline,
                            const FrameView& frame, uint64_t sequence,
                            int64_t time_ns, uint64_t missing_before,
                            v1::Posterior* posterior) {
  writer.OnFrame(pipeline.Step(frame), sequence, time_ns, missing_before);
  writer.Write(pipeline, false, posterior);
}

absl::Status ModelRegistryExample() {
  ModelRegistry registry;
  TACTUS_RETURN_IF_ERROR(registry.AddBuiltIn("default", DefaultBundle()));
  auto pinned = registry.Find("default", "robot-7");
  return absl::OkStatus();
}

void StartRead();

void AnswerPacingExample(bool reading, bool more_follow, CallQueue* queue,
                         CallEvent& nothing_more, grpc::WriteOptions& options) {
  AnswerPacing pacing;
  if (pacing.ReadsFirst()) StartRead();
  if (pacing.Holds(reading)) {
    if (pacing.BeginHold()) queue->Defer(&nothing_more);
  } else if (!pacing.Flushes(more_follow)) {
    options.set_buffer_hint();
  }
}

void CallQueueExample(grpc::ServerBuilder& builder, ArrivalGate& arrivals,
                      std::chrono::system_clock::time_point deadline) {
  CallQueue queue(builder.AddCompletionQueue(), &arrivals);
  const auto server = builder.BuildAndStart();
  queue.Start();
  queue.Post([] { Use(); });
  server->Shutdown(deadline);
  queue.Stop();
}

void ContactCallExample(RawContactService* service, CallQueue* queue,
                        ContactCall::Delegate* delegate) {
  new ContactCall(service, queue, delegate);  // awaits a call
}

void TrialCallExample(RawContactService* service, CallQueue* queue,
                      TrialCall::Delegate* delegate) {
  new TrialCall(service, queue, delegate);  // awaits a call
}

void ContactServiceExample(grpc::ServerBuilder& builder,
                           ContactService& service, CallQueue& queue) {
  builder.RegisterService(&service);
  const auto server = builder.BuildAndStart();
  service.Serve(&queue);
}

void HealthServiceExample(grpc::ServerBuilder& builder, HealthService& health,
                          CallQueue& queue) {
  health.SetServing("tactus.v1.ContactService", true);
  builder.RegisterService(&health);
  health.Serve(&queue);
}

absl::Status ServerExample(const ModelRegistry& registry) {
  TACTUS_ASSIGN_OR_RETURN(auto server, TactusServer::Start(&registry, {}));
  server->Stop();
  return absl::OkStatus();
}

absl::Status FrameDecoderExample(const StreamSettings& settings,
                                 const v1::FrameBatch& batch,
                                 ContactPipeline& pipeline) {
  FrameDecoder decoder(settings);
  TACTUS_RETURN_IF_ERROR(decoder.Check(batch));  // all or nothing
  for (uint32_t i = 0; i < batch.frame_count(); ++i) {
    pipeline.Step(decoder.Frame(batch, i));
  }
  decoder.Accept(batch);
  return absl::OkStatus();
}

absl::Status RequestParserExample(Bytes& bytes, size_t size) {
  v1::ClassifyContactRequest request;
  if (!ParseRequest(&bytes, &request)) return MalformedRequest(size);
  return absl::OkStatus();
}

absl::Status RequestLimitsExample(size_t size) {
  const size_t limit = MaxRequestBytes(*v1::TrainModelRequest::descriptor());
  if (size > limit) return MessageTooLarge(size, limit);
  return absl::OkStatus();
}

void WriteInto(v1::Posterior* posterior);

void ResponseQueueExample(ResponseQueue& queue, int64_t elapsed_ns,
                          int64_t now_ns) {
  queue.BeginRequest();
  WriteInto(queue.AddInterim());
  queue.EndRequest(elapsed_ns, now_ns);
  if (const auto* response = queue.StartWrite(now_ns)) Write(*response);
  queue.FinishWrite();
}

void Finish(const absl::Status& status);

void StreamSessionExample(const ModelSource* models, Bytes& bytes, size_t size,
                          int64_t start_ns, int64_t now_ns) {
  v1::ClassifyContactRequest request;
  StreamSession session(models, {.stream_id = "7"});
  session.OnMessage(&bytes, size, &request).IgnoreError();
  session.EndRequest(start_ns, now_ns);
  while (auto* answer = session.responses().StartWrite(now_ns)) {
    Write(*answer);
    session.responses().FinishWrite();
  }
  if (session.state() == StreamSession::State::kDone) {
    Finish(session.final_status());
  }
}

void StreamSettingsExample(const v1::StreamConfig& config) {
  auto settings = ParseStreamConfig(config);
}

void Send(const v1::ClassifyTrialResponse& response);

void TrialSessionExample(const ModelSource* models, const std::string& bytes) {
  v1::ClassifyContactRequest request;
  TrialSession trial(models, {.stream_id = "7"}, bytes);
  while (!trial.done()) trial.Step(&request);
  if (trial.status().ok()) Send(trial.response());
}

}  // namespace tactus::server::examples
