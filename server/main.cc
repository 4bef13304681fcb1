// tactusd: the server program.
#include <cstdio>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/synchronization/mutex.h"
#include "core/base/arguments.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/version.h"
#include "grpcpp/create_channel.h"
#include "server/ops/health_probe.h"
#include "server/ops/logging.h"
#include "server/ops/port_file.h"
#include "server/ops/signals.h"
#include "server/registry/default_bundle.h"
#include "server/registry/model_registry.h"
#include "server/server.h"
#include "spdlog/spdlog.h"

namespace tactus::server {
namespace {

struct Flags {
  TactusServer::Options server;
  std::vector<std::string> models;
  std::string port_file;
  std::string log_level = "info";
  std::string health_check;
  std::string tls_certificate;
  std::string tls_key;
  std::string tls_roots;
};

// 0 if the server at `address` says SERVING.
int CheckHealth(const std::string& address, const std::string& tls_roots) {
  const auto credentials = ReadTlsRoots(tls_roots);
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
  TACTUS_RETURN_IF_ERROR(registry.Add("default", DefaultBundle()));
  for (const std::string& flag : flags) {
    const size_t split = flag.find('=');
    const std::string path =
        split == std::string::npos ? "" : flag.substr(split + 1);
    TACTUS_ASSIGN_OR_RETURN(const std::string bundle, ReadBundleFile(path));
    TACTUS_RETURN_IF_ERROR(
        Annotate(registry.Add(flag.substr(0, split), bundle), path));
  }
  for (const std::string& version : registry.versions()) {
    spdlog::info("serving {}", version);
  }
  return absl::OkStatus();
}

absl::Status Serve(const Flags& flags, StopSignals& signals) {
  TACTUS_RETURN_IF_ERROR(StartLogging(flags.log_level));
  ModelRegistry registry;
  TACTUS_RETURN_IF_ERROR(LoadModels(flags.models, registry));
  TactusServer::Options options = flags.server;
  if (!flags.tls_key.empty()) {
    TACTUS_ASSIGN_OR_RETURN(
        options.tls, ReadTlsIdentity(flags.tls_certificate, flags.tls_key));
  }
  TACTUS_ASSIGN_OR_RETURN(auto server, TactusServer::Start(&registry, options));
  for (size_t i = 0; i < flags.server.listen.size(); ++i) {
    spdlog::info("listening on {}, port {}", flags.server.listen[i],
                 server->ports()[i]);
  }
  if (!flags.port_file.empty()) {
    TACTUS_RETURN_IF_ERROR(WritePortFile(flags.port_file, server->ports()[0]));
  }
  const int signal = signals.Wait();
  spdlog::info("signal {}: draining {} streams", signal, server->gate().live());
  server->Stop();
  const StreamGate& gate = server->gate();
  spdlog::info("stopped after {} streams, {} refused, {} frames", gate.opened(),
               gate.refused(), gate.frames());
  spdlog::info("skipped {}", server->skipped().ToString());
  return absl::OkStatus();
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
  CLI::Option* certificate =
      app.add_option("--tls-cert", flags.tls_certificate,
                     "PEM file of the server's certificate chain: speak TLS on "
                     "every host:port");
  CLI::Option* key =
      app.add_option("--tls-key", flags.tls_key, "PEM file of its private key");
  certificate->needs(key);
  key->needs(certificate);
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
  app.add_option("--drain-grace-ms", flags.server.drain_grace_ms,
                 "Time streams have to finish after SIGTERM")
      ->check(CLI::Range(0, 3'600'000))
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
  app.add_option("--idle-timeout-ms", flags.server.idle_timeout_ms,
                 "Silence that ends a stream; 0 for none")
      ->check(CLI::Range(0, 86'400'000))
      ->capture_default_str();
  app.add_option("--log-level", flags.log_level,
                 "trace, debug, info, warn, error or off")
      ->capture_default_str();
  app.add_option("--health-check", flags.health_check,
                 "Ask the server at this address and exit 0 if it serves");
  app.add_option("--tls-ca", flags.tls_roots,
                 "PEM file of who may vouch for the server of --health-check");
  if (const absl::Status status = CheckArguments(argc, argv); !status.ok()) {
    std::fprintf(stderr, "tactusd: %s\n",
                 std::string(status.message()).c_str());
    return 1;
  }
  CLI11_PARSE(app, argc, argv);
  if (!flags.health_check.empty()) {
    return CheckHealth(flags.health_check, flags.tls_roots);
  }
  if (flags.server.listen.empty()) flags.server.listen = {"127.0.0.1:50051"};

  // Before any thread starts, so that all inherit the blocked signals.
  StopSignals signals;
  const absl::Status status = Serve(flags, signals);
  if (!status.ok()) {
    std::fprintf(stderr, "tactusd: %s\n",
                 std::string(status.message()).c_str());
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace tactus::server

int main(int argc, char** argv) { return tactus::server::Main(argc, argv); }
