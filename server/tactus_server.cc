#include "server/tactus_server.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/version.h"
#include "grpcpp/ext/proto_server_reflection_plugin.h"
#include "grpcpp/impl/server_builder_option.h"
#include "grpcpp/impl/server_builder_plugin.h"
#include "grpcpp/server_builder.h"
#include "server/ops/alarm_clock.h"
#include "server/rpc/admin_rpcs.h"
#include "server/rpc/contact_log_rpcs.h"
#include "server/rpc/monitor_rpcs.h"
#include "server/rpc/training_rpcs.h"

namespace tactus::internal::server {
namespace {

using std::chrono::milliseconds;

constexpr char kContactService[] = "tactus.v1.ContactService";
// What is left of the last second after the grace: for the final messages, and
// for gRPC to cut off peers that do not take them.
constexpr milliseconds kLastMessages(400);
constexpr milliseconds kCutOff(200);
constexpr size_t kMemoryQuotaBytes = 512UL * 1024 * 1024;

void SetChannelArguments(int max_streams, bool uploads,
                         grpc::ServerBuilder& builder) {
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, 30'000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 10'000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(
      GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 10'000);
  // Frames are small and few: probing for more bandwidth would only add pings
  // to them, a third of all writes.
  builder.AddChannelArgument(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  // Room above our own limits, which answer with a reason.
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS,
                             max_streams + 100);
  builder.AddChannelArgument(GRPC_ARG_MAX_METADATA_SIZE, 16 * 1024);
  // Only identity: a message of 600 kB can inflate to 600 MB, and gRPC compares
  // a message's size before it inflates it. A call in another encoding ends
  // with UNIMPLEMENTED, and there is no filter that could inflate.
  for (const auto algorithm : {GRPC_COMPRESS_DEFLATE, GRPC_COMPRESS_GZIP}) {
    builder.SetCompressionAlgorithmSupportStatus(algorithm, false);
  }
  builder.AddChannelArgument(GRPC_ARG_ENABLE_PER_MESSAGE_DECOMPRESSION, 0);
  builder.SetMaxReceiveMessageSize(uploads ? limits::kMaxUploadMessageBytes
                                           : limits::kMaxReceiveBytes);
  // All calls of one read are made before any of them ends.
  builder.AddChannelArgument(GRPC_ARG_TCP_MAX_READ_CHUNK_SIZE,
                             limits::kMaxReadBytes);
  builder.SetResourceQuota(grpc::ResourceQuota("tactusd")
                               .Resize(kMemoryQuotaBytes)
                               .SetMaxThreads(limits::kMaxSyncThreads));
}

// The library of reflection registers itself with every builder.
class ReflectionOption final : public grpc::ServerBuilderOption {
 public:
  explicit ReflectionOption(bool on) : on_(on) {
    grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  }
  void UpdateArguments(grpc::ChannelArguments*) override {}
  void UpdatePlugins(std::vector<std::unique_ptr<grpc::ServerBuilderPlugin>>*
                         plugins) override {
    if (on_) return;
    std::erase_if(*plugins, [](const auto& plugin) {
      return plugin->name() == "proto_server_reflection";
    });
  }

 private:
  const bool on_;
};

// Streams of one connection, which is one peer's.
int StreamsPerConnection(const TactusServer::Options& options) {
  if (options.max_streams_per_peer == 0) return options.max_streams;
  return std::min(options.max_streams, options.max_streams_per_peer);
}

const Authorizer* Either(const Authorizer* given, const Authorizer* other) {
  return given != nullptr ? given : other;
}

int Threads(int wanted) {
  if (wanted > 0) return wanted;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency() / 2));
}

}  // namespace

absl::StatusOr<std::unique_ptr<TactusServer>> TactusServer::Start(
    const ModelSource* models, const Options& options) {
  std::unique_ptr<TactusServer> server(new TactusServer(models, options));
  TACTUS_RETURN_IF_ERROR(server->Listen());
  return server;
}

TactusServer::TactusServer(const ModelSource* models, const Options& options)
    : options_(options),
      models_(models),
      start_ms_(SystemNowMs()),
      contacts_(models, Either(options.authorizer, &without_tokens_), &metrics_,
                {.max_streams = options.max_streams,
                 .max_streams_per_peer = options.max_streams_per_peer,
                 .max_streams_per_client = options.max_streams_per_client,
                 .idle_timeout_ms = options.idle_timeout_ms,
                 .first_message_timeout_ms = options.first_message_timeout_ms,
                 .server_version = kVersion,
                 .contact_log = options.contact_log}),
      control_(
          [authorizer = Either(options.authorizer, &without_tokens_)](
              const auto& context, const auto& method, Role role) {
            return authorizer->Authorize(context, method, role);
          },
          &metrics_.rpcs) {
  AddTrainingRpcs(options.training, control_);
  AddOperationRpcs(options.training, control_);
  AddModelRpcs(options.training, control_);
  AddMonitorRpcs(&contacts_.streams(), control_);
  AddContactLogRpcs(options.contact_log, models, options.training, control_);
  AddAdminRpcs({.backend = options.training,
                .streams = [this] { return gate().live(); },
                .max_streams = options.max_streams,
                .max_streams_per_client = options.max_streams_per_client,
                .drain_grace_ms = options.drain_grace_ms,
                .drain = options.on_drain},
               control_);
}

absl::Status TactusServer::Listen() {
  grpc::ServerBuilder builder;
  builder.SetOption(std::make_unique<ReflectionOption>(options_.reflection));
  SetChannelArguments(StreamsPerConnection(options_),
                      options_.training != nullptr, builder);
  TACTUS_ASSIGN_OR_RETURN(
      listener_, GrpcListener::Open(
                     {.addresses = options_.listen,
                      .tls = options_.tls,
                      .guards = {&arrivals_, &refuser_, options_.reflection},
                      .limits = {.connections = options_.max_connections,
                                 .per_peer = options_.max_connections_per_peer},
                      .handshake_timeout_ms = options_.handshake_timeout_ms,
                      .connection_idle_ms = options_.connection_idle_ms}));
  listener_->AddTo(builder);
  builder.RegisterService(&contacts_);
  builder.RegisterService(&health_);
  builder.RegisterAsyncGenericService(control_.generic());
  for (int i = 0; i < Threads(options_.threads); ++i) {
    queues_.push_back(
        std::make_unique<CallQueue>(builder.AddCompletionQueue(), &arrivals_));
  }
  server_ = builder.BuildAndStart();
  // The sockets are open already: what is left to fail is the certificate.
  if (server_ == nullptr) {
    return IoError("TLS",
                   "the certificate and the key do not make a pair, or "
                   "there is no authority for clients");
  }
  Serve();
  return absl::OkStatus();
}

void TactusServer::Serve() {
  for (const auto& queue : queues_) {
    contacts_.Serve(queue.get());
    health_.Serve(queue.get());
    control_.Serve(queue.get());
  }
  SetServing(true);
  for (const auto& queue : queues_) queue->Start();
  listener_->Start();
}

TactusServer::~TactusServer() {
  if (server_ != nullptr) Shutdown(std::chrono::system_clock::now());
}

void TactusServer::Stop() {
  const milliseconds grace(options_.drain_grace_ms);
  SetServing(false);
  control_.StartDraining();
  contacts_.StartDraining(grace);
  if (!contacts_.WaitUntilEmpty(grace)) {
    contacts_.EndStreams();
    contacts_.WaitUntilEmpty(kLastMessages);
  }
  Shutdown(std::chrono::system_clock::now() + kCutOff);
}

void TactusServer::Shutdown(std::chrono::system_clock::time_point deadline) {
  listener_->Stop();
  {
    // gRPC waits until every call's last message is taken or its connection
    // has ended. A peer that takes nothing must not hold up the end.
    const AlarmClock cut_off(deadline + kCutOff,
                             [this] { listener_->acceptor().CutOff(); });
    server_->Shutdown(deadline);
    server_->Wait();
  }
  for (const auto& queue : queues_) queue->Stop();
  control_.StopWorkers();
  server_.reset();
}

void TactusServer::SetServing(bool serving) {
  health_.SetServing("", serving);
  health_.SetServing(kContactService, serving);
}

std::shared_ptr<grpc::Channel> TactusServer::InProcessChannel() {
  return server_->InProcessChannel({});
}

}  // namespace tactus::internal::server
