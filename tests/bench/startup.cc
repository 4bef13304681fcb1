#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/strings/str_cat.h"
#include "client/stream/channel.h"
#include "client/stream/status.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "grpcpp/impl/client_unary_call.h"
#include "grpcpp/impl/codegen/proto_utils.h"
#include "grpcpp/impl/rpc_method.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/child_server.h"
#include "tools/common/percentile.h"
#include "tools/load/connection_loop.h"
#include "tools/load/load_stream.h"

namespace tactus::internal::client {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

struct StartupOptions {
  int repetitions = 15;
  int streams = 1000;
};

// True once somebody listens on the unix socket `path`.
bool Await(const std::string& path, milliseconds timeout) {
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof(address.sun_path) - 1);
  const auto until = steady_clock::now() + timeout;
  while (steady_clock::now() < until) {
    const int socket_fd = socket(AF_UNIX, SOCK_STREAM, 0);
    const int failed =
        connect(socket_fd, reinterpret_cast<const sockaddr*>(&address),
                sizeof(address));
    close(socket_fd);
    if (failed == 0) return true;
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  return false;
}

// OK if the server's health check answers SERVING.
absl::Status CheckServing(const std::shared_ptr<grpc::Channel>& channel) {
  const grpc::internal::RpcMethod method(
      "/grpc.health.v1.Health/Check",
      grpc::internal::RpcMethod::RpcType::NORMAL_RPC);
  grpc::ClientContext context;
  const grpc::ByteBuffer request(nullptr, 0);
  grpc::ByteBuffer answer;
  TACTUS_RETURN_IF_ERROR(FromGrpcStatus(
      grpc::internal::BlockingUnaryCall<grpc::ByteBuffer, grpc::ByteBuffer>(
          channel.get(), method, &context, request, &answer)));
  grpc::Slice bytes;
  // HealthCheckResponse{status: SERVING}.
  const std::string serving = "\x08\x01";
  if (!answer.DumpToSingleSlice(&bytes).ok() ||
      std::string(bytes.begin(), bytes.end()) != serving) {
    return IoError("tactusd", "does not say SERVING");
  }
  return absl::OkStatus();
}

// Milliseconds from starting tactusd to its answer SERVING.
absl::StatusOr<double> TimeStart() {
  const std::string path = std::filesystem::temp_directory_path() /
                           absl::StrCat("tactus-start-", getpid(), ".sock");
  std::filesystem::remove(path);
  const auto start = steady_clock::now();
  TACTUS_ASSIGN_OR_RETURN(
      const pid_t pid,
      SpawnBeside("tactusd", {"--listen=unix:" + path, "--log-level=error",
                              "--drain-grace-ms=0"}));
  absl::Status status = Await(path, milliseconds(10'000))
                            ? CheckServing(MakeChannel(
                                  "unix:" + path, {.share_connection = false}))
                            : IoError(path, "nobody listens after 10 s");
  const std::chrono::duration<double, std::milli> elapsed =
      steady_clock::now() - start;
  EndProcess(pid);
  std::filesystem::remove(path);
  TACTUS_RETURN_IF_ERROR(status);
  return elapsed.count();
}

// Streams that sent their configuration and nothing else.
class IdleStreams {
 public:
  explicit IdleStreams(const FrameScript* script) { shared_.script = script; }
  ~IdleStreams() {
    for (const auto& stream : streams_) stream->Close();
    loop_.HandleUntil([this] { return shared_.ended == Count(); }, kTimeout);
  }

  // Sends a frame on each and takes its answer.
  absl::Status PlayOneFrame() {
    const Schedule now(Count(), LoadClockNs(), 1, 1);
    shared_.schedule = &now;
    for (const auto& stream : streams_) stream->Offer();
    const auto all_answered = [this] {
      return std::all_of(streams_.begin(), streams_.end(),
                         [](const auto& stream) {
                           return stream->answered() == stream->offered();
                         });
    };
    if (!loop_.HandleUntil(all_answered, kTimeout)) {
      return StreamIdle(kTimeout.count());
    }
    return absl::OkStatus();
  }

  // Opens `count` more, which share so many connections; an error unless the
  // server accepts all.
  absl::Status Open(int count, const ServerPlace& server, int connections) {
    std::vector<std::shared_ptr<GrpcConnection>> shared;
    for (int i = 0; i < connections; ++i) {
      shared.push_back(std::make_shared<GrpcConnection>(&loop_, server));
    }
    for (int i = 0; i < count; ++i) {
      streams_.push_back(std::make_unique<LoadStream>(
          &shared_, LoadStream::Options{.robot = Count()}));
      streams_.back()->Open(shared[i % connections]);
    }
    loop_.HandleUntil([this] { return shared_.settled == Count(); }, kTimeout);
    for (const auto& stream : streams_) {
      if (!stream->accepted()) return IoError("tactusd", "refused a stream");
    }
    return absl::OkStatus();
  }

 private:
  static constexpr milliseconds kTimeout{30'000};

  int Count() const { return static_cast<int>(streams_.size()); }

  LoadShared shared_;
  // Outlives the streams' connections.
  ConnectionLoop loop_;
  std::vector<std::unique_ptr<LoadStream>> streams_;
};

// KiB a stream.
struct Memory {
  double configured = 0;
  double played = 0;
};

// Memory of `count` streams on `connections` connections.
absl::StatusOr<Memory> StreamMemory(const FrameScript& script, int count,
                                    int connections) {
  TACTUS_ASSIGN_OR_RETURN(
      const auto server,
      ChildServer::Start("tactusd",
                         {"--listen=127.0.0.1:0", "--log-level=error",
                          "--max-streams=100000", "--max-streams-per-peer=0"}));
  TACTUS_ASSIGN_OR_RETURN(const ServerPlace place,
                          ServerPlace::Find(server->address(), std::nullopt));
  IdleStreams streams(&script);
  // What the first streams bring with them is the server's own.
  TACTUS_RETURN_IF_ERROR(streams.Open(10, place, 1));
  const double before = server->ResidentKib();
  TACTUS_RETURN_IF_ERROR(streams.Open(count, place, connections));
  Memory memory;
  memory.configured = (server->ResidentKib() - before) / count;
  TACTUS_RETURN_IF_ERROR(streams.PlayOneFrame());
  memory.played = (server->ResidentKib() - before) / count;
  return memory;
}

class StartupBenchmark : public Benchmark {
 public:
  const char* name() const override { return "startup"; }
  const char* description() const override {
    return "Start of the server, and the memory of an idle stream";
  }

  void AddFlags(CLI::App& command) override {
    command.add_option("--repetitions", options_.repetitions, "Starts")
        ->check(CLI::Range(1, 10'000))
        ->capture_default_str();
    command.add_option("--streams", options_.streams, "Idle streams")
        ->check(CLI::Range(10, 50'000))
        ->capture_default_str();
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    const int starts = quick ? 2 : options_.repetitions;
    const int streams = quick ? 50 : options_.streams;
    std::vector<double> milliseconds;
    for (int i = 0; i < starts; ++i) {
      TACTUS_ASSIGN_OR_RETURN(const double elapsed, TimeStart());
      milliseconds.push_back(elapsed);
    }
    TACTUS_ASSIGN_OR_RETURN(const FrameScript script,
                            FrameScript::Create({.contacts = 1}));
    TACTUS_ASSIGN_OR_RETURN(const Memory shared,
                            StreamMemory(script, streams, 8));
    TACTUS_ASSIGN_OR_RETURN(const Memory own,
                            StreamMemory(script, streams, streams));
    return std::vector<BenchRow>{{.name = "startup/serving",
                                  .unit = "ms",
                                  .ours = Percentile(milliseconds, 0.5)},
                                 {.name = "startup/stream_memory",
                                  .unit = "KiB",
                                  .ours = shared.configured},
                                 {.name = "startup/stream_memory_played",
                                  .unit = "KiB",
                                  .ours = shared.played},
                                 {.name = "startup/connection_memory",
                                  .unit = "KiB",
                                  .ours = own.configured}};
  }

 private:
  StartupOptions options_;
};

}  // namespace

std::unique_ptr<Benchmark> MakeStartupBenchmark() {
  return std::make_unique<StartupBenchmark>();
}

}  // namespace tactus::internal::client
