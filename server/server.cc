#include "server/server.h"

#include <chrono>
#include <utility>

#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/version.h"
#include "grpcpp/ext/proto_server_reflection_plugin.h"
#include "grpcpp/health_check_service_interface.h"
#include "grpcpp/server_builder.h"

namespace tactus::server {
namespace {

using std::chrono::milliseconds;

constexpr char kContactService[] = "tactus.v1.ContactService";
// What is left of the last second after the grace: for the final messages, and
// for gRPC to cut off peers that do not take them.
constexpr milliseconds kLastMessages(400);
constexpr milliseconds kCutOff(200);
constexpr size_t kMemoryQuotaBytes = 512UL * 1024 * 1024;

void SetChannelArguments(int max_streams, grpc::ServerBuilder& builder) {
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, 30'000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 10'000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(
      GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 10'000);
  // Room above our own limit, which answers with a reason.
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS,
                             max_streams + 100);
  builder.AddChannelArgument(GRPC_ARG_MAX_METADATA_SIZE, 16 * 1024);
  // A second server on the same port is a mistake and must fail.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.SetResourceQuota(
      grpc::ResourceQuota("tactusd").Resize(kMemoryQuotaBytes));
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
      contacts_(models, {.max_streams = options.max_streams,
                         .idle_timeout_ms = options.idle_timeout_ms,
                         .server_version = kVersion}) {}

absl::Status TactusServer::Listen() {
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  SetChannelArguments(options_.max_streams, builder);
  ports_.resize(options_.listen.size());
  const TlsIdentity* tls = options_.tls ? &*options_.tls : nullptr;
  for (size_t i = 0; i < options_.listen.size(); ++i) {
    builder.AddListeningPort(options_.listen[i],
                             CredentialsFor(options_.listen[i], tls),
                             &ports_[i]);
  }
  builder.RegisterService(&contacts_);
  builder.RegisterCallbackGenericService(&unimplemented_);
  server_ = builder.BuildAndStart();
  if (server_ == nullptr) {
    std::string addresses;
    for (const std::string& address : options_.listen) {
      absl::StrAppend(&addresses, addresses.empty() ? "" : ", ", address);
    }
    return IoError(addresses, tls == nullptr
                                  ? "cannot listen there"
                                  : "cannot listen there, or the certificate "
                                    "and the key are no pair");
  }
  SetServing(true);
  keep_warm_ = std::make_unique<KeepWarm>(InProcessChannel());
  return absl::OkStatus();
}

TactusServer::~TactusServer() {
  keep_warm_.reset();
  if (server_ == nullptr) return;
  server_->Shutdown(std::chrono::system_clock::now());
  server_->Wait();
}

void TactusServer::Stop() {
  const milliseconds grace(options_.drain_grace_ms);
  SetServing(false);
  contacts_.StartDraining(grace);
  if (!contacts_.WaitUntilEmpty(grace)) {
    contacts_.EndStreams();
    contacts_.WaitUntilEmpty(kLastMessages);
  }
  keep_warm_.reset();
  server_->Shutdown(std::chrono::system_clock::now() + kCutOff);
  server_->Wait();
  server_.reset();
}

void TactusServer::SetServing(bool serving) {
  grpc::HealthCheckServiceInterface* health = server_->GetHealthCheckService();
  health->SetServingStatus(serving);
  health->SetServingStatus(kContactService, serving);
}

std::shared_ptr<grpc::Channel> TactusServer::InProcessChannel() {
  return server_->InProcessChannel({});
}

}  // namespace tactus::server
