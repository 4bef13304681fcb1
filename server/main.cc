// tactusd: the server program.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "core/base/address.h"
#include "core/base/arguments.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/limits_contact_log.h"
#include "core/base/limits_training.h"
#include "core/base/status_macros.h"
#include "core/base/thread_priority.h"
#include "core/base/version.h"
#include "core/postgres/pg_connection.h"
#include "core/postgres/postgres_catalog.h"
#include "grpcpp/create_channel.h"
#include "server/contact_log/contact_log.h"
#include "server/jobs/training_backend.h"
#include "server/listen/self_check.h"
#include "server/metrics/metrics_listener.h"
#include "server/ops/authorizer.h"
#include "server/ops/file_watch.h"
#include "server/ops/health_probe.h"
#include "server/ops/logging.h"
#include "server/ops/port_file.h"
#include "server/ops/service_notify.h"
#include "server/ops/signals.h"
#include "server/registry/default_bundle.h"
#include "server/registry/model_registry.h"
#include "server/start_checks.h"
#include "server/tactus_server.h"
#include "server/training_flags.h"
#include "spdlog/spdlog.h"

namespace tactus::internal::server {
namespace {

struct Flags {
  TactusServer::Options server;
  std::vector<std::string> models;
  std::string port_file;
  std::string log_level = "info";
  LogFormat log_format = LogFormat::kText;
  std::string metrics;
  // Bytes; 0: contacts are not kept.
  uint64_t keep_contacts = 0;
  std::string health_check;
  std::optional<std::string> tls_certificate;
  std::optional<std::string> tls_key;
  std::optional<std::string> tls_roots;
  std::optional<std::string> tls_client_roots;
  std::optional<std::string> tokens;
  int self_check_ms = limits::kSelfCheckMs;
  TrainingFlags training;
  bool behind_proxy = false;
  int drain_notice_ms = 0;
};

absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> HealthCredentials(
    const Flags& flags) {
  if (IsUnixAddress(flags.health_check)) {
    return grpc::InsecureChannelCredentials();
  }
  if (flags.tls_roots) return ReadTlsRoots(*flags.tls_roots);
  if (flags.tls_certificate) return ReadOwnCertificate(*flags.tls_certificate);
  return grpc::InsecureChannelCredentials();
}

// 0 if the server at flags.health_check reports SERVING.
int CheckHealth(const Flags& flags) {
  const std::string& address = flags.health_check;
  const auto credentials = HealthCredentials(flags);
  if (!credentials.ok()) {
    std::fprintf(stderr, "tactusd: %s\n",
                 std::string(credentials.status().message()).c_str());
    return 1;
  }
  const auto channel = grpc::CreateChannel(address, *credentials);
  const auto serving = ProbeHealth(channel, "", std::chrono::seconds(3));
  if (!serving.ok()) {
    std::fprintf(stderr, "%s: %s\n", address.c_str(),
                 serving.status().ToString().c_str());
    return 1;
  }
  std::printf("%s\n", *serving ? "SERVING" : "NOT_SERVING");
  return *serving ? 0 : 1;
}

absl::Status LoadModels(const std::vector<std::string>& flags,
                        ModelRegistry& registry) {
  TACTUS_RETURN_IF_ERROR(registry.AddBuiltIn("default", DefaultBundle()));
  TACTUS_RETURN_IF_ERROR(registry.AddBuiltIn("no-poses", NoPosesBundle()));
  for (const std::string& flag : flags) {
    const size_t split = flag.find('=');
    const std::string path =
        split == std::string::npos ? "" : flag.substr(split + 1);
    TACTUS_ASSIGN_OR_RETURN(const std::string bundle, ReadBundleFile(path));
    TACTUS_RETURN_IF_ERROR(
        Annotate(registry.AddBuiltIn(flag.substr(0, split), bundle), path));
  }
  for (const std::string& version : registry.versions()) {
    spdlog::info("serving {}", version);
  }
  return absl::OkStatus();
}

// Null without --data-dir or --catalog.
absl::StatusOr<std::unique_ptr<TrainingBackend>> OpenTraining(
    const Flags& flags, ModelRegistry* registry) {
  if (!flags.training.given()) return std::unique_ptr<TrainingBackend>();
  TACTUS_RETURN_IF_ERROR(flags.training.Check());
  TACTUS_ASSIGN_OR_RETURN(
      auto training,
      TrainingBackend::Open(flags.training.Options(flags.server.listen.front()),
                            registry));
  for (const std::string& failure : training->failures()) {
    spdlog::error("not served: {}", failure);
  }
  if (const Replica* const replica = training->replica(); replica != nullptr) {
    spdlog::info("{} of {}, folder {}", replica->name(),
                 ShownAddress(flags.training.catalog), flags.training.blobs);
  } else {
    spdlog::info("data directory {}", flags.training.data_dir);
  }
  training->Start();
  return training;
}

absl::StatusOr<std::unique_ptr<ContactLog>> OpenContactLog(
    const Flags& flags, const ModelSource& models) {
  if (flags.keep_contacts == 0) return std::unique_ptr<ContactLog>();
  TACTUS_ASSIGN_OR_RETURN(
      auto log,
      ContactLog::Open(
          {.folder = absl::StrCat(flags.training.data_dir, "/contacts"),
           .max_bytes = static_cast<int64_t>(flags.keep_contacts),
           .models = &models}));
  for (const std::string& line : log->damage()) {
    spdlog::error("the contact log is damaged: {}", line);
  }
  spdlog::info("keeps contacts: {} are there, in {} of {} bytes",
               log->totals().contacts, log->totals().bytes,
               log->totals().max_bytes);
  return log;
}

// Tokens on a plain connection can be read on the way.
void WarnOfPlainTokens(const Flags& flags) {
  if (!flags.tokens || flags.tls_certificate) return;
  for (const std::string& address : flags.server.listen) {
    if (StaysOnThisHost(address)) continue;
    spdlog::warn("tokens reach {} unencrypted; use --tls-cert and --tls-key",
                 address);
  }
}

void ReloadTokens(Authorizer& authorizer) {
  const absl::Status status = authorizer.Reload();
  if (status.ok()) {
    spdlog::info("the tokens file is loaded again");
  } else {
    spdlog::error("the old tokens stay: {}", std::string(status.message()));
  }
}

void Notify(absl::string_view state) {
  const absl::Status status = NotifyService(state);
  if (!status.ok()) spdlog::warn("systemd: {}", std::string(status.message()));
}

[[noreturn]] void EndAsUnreachable(const std::string& address,
                                   const absl::Status& error, int patience_ms) {
  spdlog::critical("{} has not answered its own server for {} ms ({}); ending",
                   address, patience_ms, std::string(error.message()));
  spdlog::default_logger()->flush();
  // Without a drain: what is broken may not let it end.
  std::_Exit(EXIT_FAILURE);
}

absl::Status Serve(const Flags& flags, StopSignals& signals) {
  TACTUS_RETURN_IF_ERROR(StartLogging(flags.log_level, flags.log_format));
  ModelRegistry registry;
  TACTUS_RETURN_IF_ERROR(LoadModels(flags.models, registry));
  TactusServer::Options options = flags.server;
  TACTUS_ASSIGN_OR_RETURN(const auto training, OpenTraining(flags, &registry));
  options.training = training.get();
  TACTUS_ASSIGN_OR_RETURN(const auto contact_log,
                          OpenContactLog(flags, registry));
  options.contact_log = contact_log.get();
  FitConnections(flags.behind_proxy, options);
  if (flags.tls_certificate) {
    TACTUS_ASSIGN_OR_RETURN(
        options.tls, ReadTlsIdentity(*flags.tls_certificate, *flags.tls_key));
  }
  if (flags.tls_client_roots) {
    TACTUS_ASSIGN_OR_RETURN(options.tls->client_roots,
                            ReadClientRoots(*flags.tls_client_roots));
  }
  auto authorizer = std::make_unique<Authorizer>(
      flags.behind_proxy ? Authorizer::Loopback::kProxy
                         : Authorizer::Loopback::kThisHost);
  if (flags.tokens) {
    TACTUS_ASSIGN_OR_RETURN(authorizer, Authorizer::Open(*flags.tokens));
    WarnOfPlainTokens(flags);
  }
  options.authorizer = authorizer.get();
  // As from outside, so that both ways are one.
  options.on_drain = [] { kill(getpid(), SIGTERM); };
  TACTUS_ASSIGN_OR_RETURN(auto server, TactusServer::Start(&registry, options));
  LogListeners(options, *server);
  WarnOfDirectListeners(options.listen);
  std::unique_ptr<MetricsListener> metrics;
  if (!flags.metrics.empty()) {
    TACTUS_ASSIGN_OR_RETURN(metrics,
                            MetricsListener::Start(flags.metrics, [&server] {
                              return server->CollectMetrics();
                            }));
    spdlog::info("metrics on {}, port {}", flags.metrics, metrics->port());
  }
  if (!flags.port_file.empty()) {
    TACTUS_RETURN_IF_ERROR(WritePortFile(flags.port_file, server->ports()[0]));
  }
  Notify("READY=1");
  std::optional<SelfCheck> self_check(
      std::in_place, server->listener(),
      SelfCheck::Options{
          .patience = std::chrono::milliseconds(flags.self_check_ms),
          .on_pass = [] { Notify("WATCHDOG=1"); },
          .on_failure =
              [&flags](const std::string& address, const absl::Status& error) {
                EndAsUnreachable(address, error, flags.self_check_ms);
              }});
  // Servers that share a catalogue share the file, and one person changes it.
  std::optional<FileWatch> tokens;
  if (flags.tokens && !flags.training.catalog.empty()) {
    tokens.emplace(*flags.tokens, [&authorizer] { ReloadTokens(*authorizer); });
  }
  const int signal =
      flags.tokens ? signals.Wait([&authorizer] { ReloadTokens(*authorizer); })
                   : signals.Wait();
  Notify("STOPPING=1");
  server->AnnounceStop();
  if (flags.drain_notice_ms > 0) {
    spdlog::info("signal {}: NOT_SERVING, draining in {} ms", signal,
                 flags.drain_notice_ms);
    std::this_thread::sleep_for(
        std::chrono::milliseconds(flags.drain_notice_ms));
  }
  spdlog::info("signal {}: draining {} streams", signal, server->gate().live());
  tokens.reset();
  self_check.reset();
  if (training != nullptr) training->Stop();
  server->Stop();
  metrics.reset();
  const StreamGate& gate = server->gate();
  spdlog::info("stopped after {} streams, {} refused, {} frames", gate.opened(),
               gate.refused(), gate.frames());
  spdlog::info("skipped {}", server->skipped().ToString());
  return absl::OkStatus();
}

bool IsSetButEmpty(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value == '\0';
}

int Main(int argc, char** argv) {
  // Debian's Abseil keeps a graph of all locks to find deadlocks, which costs
  // gRPC a twentieth of its time.
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
  Flags flags;
  CLI::App app("Tactus server: tells a robot what its skin touches.",
               "tactusd");
  app.set_version_flag("--version", std::string("tactusd ") + kVersion);
  app.add_option("--listen", flags.server.listen,
                 "host:port or unix:path; may be repeated; port 0 takes any "
                 "free one")
      ->default_str("127.0.0.1:50051");
  app.add_option("--port-file", flags.port_file,
                 "File to write the first address's port to once serving");
  app.add_option("--tls-cert", flags.tls_certificate,
                 "PEM file of the server's certificate chain: speak TLS on "
                 "every host:port")
      ->envname("TACTUSD_TLS_CERT")
      ->check(CLI::ExistingFile);
  app.add_option("--tls-key", flags.tls_key, "PEM file of its private key")
      ->envname("TACTUSD_TLS_KEY")
      ->check(CLI::ExistingFile);
  app.add_option("--tls-client-ca", flags.tls_client_roots,
                 "PEM file of the authorities that may vouch for clients; the "
                 "lines \"certificate NAME ROLE\" of --tokens give their "
                 "certificates roles")
      ->envname("TACTUSD_TLS_CLIENT_CA")
      ->check(CLI::ExistingFile);
  app.add_option("--tokens", flags.tokens,
                 "File of tokens and roles (trainctl tokens create): every "
                 "call but health checks needs one; read again on SIGHUP")
      ->envname("TACTUSD_TOKENS")
      ->check(CLI::ExistingFile);
  app.add_option("--model", flags.models,
                 "NAME=PATH of a bundle to serve as models/NAME; may be "
                 "repeated")
      ->check(CLI::Validator(
          [](const std::string& text) {
            return text.find('=') == std::string::npos
                       ? std::string("must be NAME=PATH")
                       : std::string();
          },
          "NAME=PATH"));
  app.add_option("--data-dir", flags.training.data_dir,
                 "Folder for datasets, jobs and models; without it, the server "
                 "only classifies");
  flags.training.AddCatalog(app);
  flags.training.AddBlobCache(app);
  flags.training.AddJobs({"local", "slurm", "none"}, app);
  flags.training.AddQuotas(app);
  app.add_option("--keep-contacts", flags.keep_contacts,
                 "Keep the last contacts in the data directory, in so many "
                 "bytes, such as 1G: people see them with trainctl contacts, "
                 "and make training data of them")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/false))
      ->check(CLI::Range(static_cast<uint64_t>(limits::kMinContactLogBytes),
                         uint64_t{1} << 50));
  app.add_option("--quota-streams", flags.server.max_streams_per_client,
                 "Streams that one client may have open; 0 for no limit")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  app.add_option("--drain-grace-ms", flags.server.drain_grace_ms,
                 "Time streams have to finish after SIGTERM, SIGINT or, "
                 "without --tokens, SIGHUP")
      ->check(CLI::Range(0, 3'600'000))
      ->capture_default_str();
  app.add_option(
         "--drain-notice-ms", flags.drain_notice_ms,
         "Time before that grace in which the server reports NOT_SERVING and "
         "still takes streams, so that a proxy that asks for its "
         "health can give them to others first (deploy/haproxy.cfg)")
      ->check(CLI::Range(0, 60'000))
      ->capture_default_str();
  app.add_option("--threads", flags.server.threads,
                 "Threads that serve streams; 0: half as many as there are "
                 "processors")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_option("--max-streams", flags.server.max_streams,
                 "Streams admitted at once")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  app.add_option("--max-connections", flags.server.max_connections,
                 "Connections open at once; fewer if the limit of open files "
                 "is lower")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  CLI::Option* behind_proxy = app.add_flag(
      "--behind-proxy", flags.behind_proxy,
      "Callers from loopback addresses come through a proxy (HAProxy with "
      "deploy/haproxy.cfg): without --tokens they may only classify, and "
      "limits per host are the proxy's");
  app.add_option("--max-connections-per-peer",
                 flags.server.max_connections_per_peer,
                 "Connections from one IPv4 address or IPv6 /64; at most half "
                 "of all")
      ->excludes(behind_proxy)
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app.add_option("--connection-idle-ms", flags.server.connection_idle_ms,
                 "Closes a connection that has had no call for this long")
      ->check(CLI::Range(1'000, 86'400'000))
      ->capture_default_str();
  app.add_option("--self-check-ms", flags.self_check_ms,
                 "Ends the process when one of its addresses has not "
                 "answered for this long")
      ->check(CLI::Range(100, 3'600'000))
      ->capture_default_str();
  app.add_option("--max-streams-per-peer", flags.server.max_streams_per_peer,
                 "Streams admitted at once from one host (an IPv6 /64 network "
                 "and all unix sockets count as one); 0 for no limit")
      ->excludes(behind_proxy)
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  app.add_flag("--reflection", flags.server.reflection,
               "Serve gRPC reflection, so that tools such as grpcurl can list "
               "the services");
  app.add_option("--idle-timeout-ms", flags.server.idle_timeout_ms,
                 "Silence that ends a stream; 0 for none")
      ->check(CLI::Range(0, 86'400'000))
      ->capture_default_str();
  app.add_option("--metrics", flags.metrics,
                 "IP:port, or a port of 127.0.0.1, where Prometheus reads "
                 "/metrics; without it there is no such listener")
      ->envname("TACTUSD_METRICS");
  app.add_option("--log-level", flags.log_level,
                 "trace, debug, info, warn, error or off")
      ->capture_default_str();
  app.add_option("--log-format", flags.log_format,
                 "text, or json: an object with time, level and message")
      ->transform(CLI::CheckedTransformer(std::map<std::string, LogFormat>{
          {"text", LogFormat::kText}, {"json", LogFormat::kJson}}));
  app.add_option("--health-check", flags.health_check,
                 "Ask the server at this address and exit 0 if it serves");
  app.add_option("--tls-ca", flags.tls_roots,
                 "PEM file of the authorities that may vouch for the server of "
                 "--health-check; without it, --tls-cert is the server's own "
                 "certificate, accepted under any name")
      ->check(CLI::ExistingFile);
  if (const absl::Status status = CheckArguments(argc, argv); !status.ok()) {
    std::fprintf(stderr, "tactusd: %s\n",
                 std::string(status.message()).c_str());
    return 1;
  }
  CLI11_PARSE(app, argc, argv);
  if (!flags.health_check.empty()) return CheckHealth(flags);
  // An empty variable must not mean plaintext.
  if (flags.tls_certificate.has_value() != flags.tls_key.has_value() ||
      IsSetButEmpty("TACTUSD_TLS_CERT") || IsSetButEmpty("TACTUSD_TLS_KEY")) {
    std::fprintf(stderr,
                 "tactusd: --tls-cert and --tls-key (or TACTUSD_TLS_CERT and "
                 "TACTUSD_TLS_KEY) must both be given, not empty\n");
    return 1;
  }
  if (IsSetButEmpty("TACTUSD_TOKENS") ||
      IsSetButEmpty("TACTUSD_TLS_CLIENT_CA")) {
    std::fprintf(stderr,
                 "tactusd: TACTUSD_TOKENS and TACTUSD_TLS_CLIENT_CA must not "
                 "be empty\n");
    return 1;
  }
  if (flags.tls_client_roots && !(flags.tokens && flags.tls_certificate)) {
    std::fprintf(stderr,
                 "tactusd: --tls-client-ca needs --tls-cert and --tls-key, and "
                 "--tokens, whose file gives certificates their roles\n");
    return 1;
  }
  if (flags.keep_contacts > 0 && flags.training.data_dir.empty()) {
    std::fprintf(stderr, "tactusd: --keep-contacts needs --data-dir\n");
    return 1;
  }
  if (flags.server.listen.empty()) flags.server.listen = {"127.0.0.1:50051"};

  // Before any thread starts, so that all inherit the blocked signals and the
  // priority.
  StopSignals signals;
  SetThreadPriority(ThreadPriority::kPrompt);
  const absl::Status status = Serve(flags, signals);
  if (!status.ok()) {
    std::fprintf(stderr, "tactusd: %s\n",
                 std::string(status.message()).c_str());
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace tactus::internal::server

int main(int argc, char** argv) {
  return tactus::internal::server::Main(argc, argv);
}
