#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "client/stream/channel.h"
#include "core/base/status_macros.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/byte_stream.h"
#include "tests/bench/child_server.h"
#include "tests/bench/haproxy.h"
#include "tests/bench/timing.h"

namespace tactus::internal::client {
namespace {

enum class Way { kDirect, kThroughHaproxy };

struct StreamOptions {
  int rounds = 15;
  // A round trips one by one, then as many with `window` in flight.
  int messages = 2000;
  int window = 16;
};

// One server and the stream to it, and what was measured of it.
class Side {
 public:
  static absl::StatusOr<std::unique_ptr<Side>> Start(
      const std::string& program, const std::vector<std::string>& arguments,
      const FrameScript* script, bool untouched = false,
      Way way = Way::kDirect) {
    auto side = std::make_unique<Side>();
    TACTUS_ASSIGN_OR_RETURN(side->server_,
                            ChildServer::Start(program, arguments));
    std::string address = side->server_->address();
    if (way == Way::kThroughHaproxy) {
      TACTUS_ASSIGN_OR_RETURN(side->proxy_, Haproxy::Start(address));
      address = side->proxy_->address();
    }
    TACTUS_ASSIGN_OR_RETURN(side->stream_,
                            ByteStream::Open(MakeChannel(address), script,
                                             {.echo = program != "tactusd",
                                              .untouched = untouched}));
    return side;
  }

  absl::Status Round(const StreamOptions& options) {
    TACTUS_RETURN_IF_ERROR(stream_->PingPong(options.messages, &rtt_us_));
    const double cpu = server_->CpuSeconds();
    const uint64_t answered = stream_->answered();
    absl::Status status;
    const double seconds = SecondsOf(
        [&] { status = stream_->Play(options.messages, options.window); });
    TACTUS_RETURN_IF_ERROR(status);
    const auto answers = static_cast<double>(stream_->answered() - answered);
    rates_.push_back(answers / seconds);
    cpu_seconds_ += server_->CpuSeconds() - cpu;
    answers_ += answers;
    return absl::OkStatus();
  }
  // What came before warmed up.
  void Forget() {
    rtt_us_.clear();
    rates_.clear();
    cpu_seconds_ = 0;
    answers_ = 0;
  }

  const ByteStream& stream() const { return *stream_; }
  double rtt_ms() const { return Percentile(rtt_us_, 0.5) / 1e3; }
  double rate() const { return Percentile(rates_, 0.5); }
  double cpu_ns() const { return cpu_seconds_ / answers_ * 1e9; }

 private:
  std::unique_ptr<ChildServer> server_;
  // Null if the stream goes to the server directly.
  std::unique_ptr<Haproxy> proxy_;
  std::unique_ptr<ByteStream> stream_;
  std::vector<double> rtt_us_;
  std::vector<double> rates_;
  double cpu_seconds_ = 0;
  double answers_ = 0;
};

absl::StatusOr<std::vector<BenchRow>> MeasureStream(
    const StreamOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(const FrameScript script, FrameScript::Create({}));
  TACTUS_ASSIGN_OR_RETURN(
      auto ours,
      Side::Start("tactusd", {"--listen=127.0.0.1:0", "--log-level=error"},
                  &script));
  TACTUS_ASSIGN_OR_RETURN(
      auto untouched,
      Side::Start("tactusd", {"--listen=127.0.0.1:0", "--log-level=error"},
                  &script, true));
  TACTUS_RETURN_IF_ERROR(ours->Round(options));
  const std::vector<std::string> echo = {
      "echo-server",
      absl::StrCat("--answer=",
                   absl::BytesToHexString(ours->stream().typical_answer()))};
  std::vector<std::string> callback_echo = echo;
  callback_echo.push_back("--callbacks");
  TACTUS_ASSIGN_OR_RETURN(auto queue,
                          Side::Start("tactus-bench", echo, &script));
  TACTUS_ASSIGN_OR_RETURN(auto callback,
                          Side::Start("tactus-bench", callback_echo, &script));
  std::vector<Side*> sides = {ours.get(), untouched.get(), queue.get(),
                              callback.get()};
  std::unique_ptr<Side> proxied;
  std::unique_ptr<Side> proxied_echo;
  if (Haproxy::Installed()) {
    TACTUS_ASSIGN_OR_RETURN(
        proxied, Side::Start("tactusd",
                             {"--listen=127.0.0.1:0", "--log-level=error",
                              "--behind-proxy"},
                             &script, false, Way::kThroughHaproxy));
    TACTUS_ASSIGN_OR_RETURN(proxied_echo,
                            Side::Start("tactus-bench", echo, &script, false,
                                        Way::kThroughHaproxy));
    sides.push_back(proxied.get());
    sides.push_back(proxied_echo.get());
  }
  for (Side* side : sides) {
    TACTUS_RETURN_IF_ERROR(side->Round(options));
    side->Forget();
  }
  for (int i = 0; i < options.rounds; ++i) {
    for (Side* side : sides) {
      TACTUS_RETURN_IF_ERROR(side->Round(options));
    }
  }
  const char* const bare = "bare gRPC echo, completion queue";
  const char* const bare_callback = "bare gRPC echo, callbacks";
  std::vector<BenchRow> rows = {
      {.name = "stream/throughput",
       .unit = "1/s",
       .ours = ours->rate(),
       .peer = queue->rate(),
       .peer_name = bare},
      {.name = "stream/rtt_p50",
       .unit = "ms",
       .ours = ours->rtt_ms(),
       .peer = queue->rtt_ms(),
       .peer_name = bare},
      {.name = "stream/server_cpu",
       .unit = "ns",
       .ours = ours->cpu_ns(),
       .peer = queue->cpu_ns(),
       .peer_name = bare},
      {.name = "stream/untouched_throughput",
       .unit = "1/s",
       .ours = untouched->rate(),
       .peer = queue->rate(),
       .peer_name = bare},
      {.name = "stream/untouched_rtt_p50",
       .unit = "ms",
       .ours = untouched->rtt_ms(),
       .peer = queue->rtt_ms(),
       .peer_name = bare},
      {.name = "stream/superseded",
       .unit = "answers",
       .ours = static_cast<double>(ours->stream().superseded())},
      {.name = "stream/echo_cq_vs_callback_throughput",
       .unit = "1/s",
       .ours = queue->rate(),
       .peer = callback->rate(),
       .peer_name = bare_callback},
      {.name = "stream/echo_cq_vs_callback_rtt_p50",
       .unit = "ms",
       .ours = queue->rtt_ms(),
       .peer = callback->rtt_ms(),
       .peer_name = bare_callback},
      {.name = "stream/echo_cq_vs_callback_server_cpu",
       .unit = "ns",
       .ours = queue->cpu_ns(),
       .peer = callback->cpu_ns(),
       .peer_name = bare_callback}};
  if (proxied == nullptr) return rows;
  const char* const proxied_bare = "bare gRPC echo through the same HAProxy";
  rows.push_back({.name = "stream/proxied_throughput",
                  .unit = "1/s",
                  .ours = proxied->rate(),
                  .peer = proxied_echo->rate(),
                  .peer_name = proxied_bare});
  rows.push_back({.name = "stream/proxied_rtt_p50",
                  .unit = "ms",
                  .ours = proxied->rtt_ms(),
                  .peer = proxied_echo->rtt_ms(),
                  .peer_name = proxied_bare});
  rows.push_back({.name = "stream/proxy_added_rtt_p50",
                  .unit = "ms",
                  .ours = proxied->rtt_ms() - ours->rtt_ms(),
                  .peer = proxied_echo->rtt_ms() - queue->rtt_ms(),
                  .peer_name = proxied_bare});
  return rows;
}

class StreamBenchmark : public Benchmark {
 public:
  const char* name() const override { return "stream"; }
  const char* description() const override {
    return "One stream against a bare gRPC echo";
  }

  void AddFlags(CLI::App& command) override {
    command.add_option("--rounds", options_.rounds, "How often")
        ->check(CLI::Range(1, 100'000))
        ->capture_default_str();
    command.add_option("--messages", options_.messages, "Messages a round")
        ->check(CLI::Range(1, 10'000'000))
        ->capture_default_str();
    command.add_option("--window", options_.window, "Messages in flight")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    StreamOptions options = options_;
    if (quick) options.rounds = 2;
    if (quick) options.messages = 200;
    return MeasureStream(options);
  }

 private:
  StreamOptions options_;
};

}  // namespace

std::unique_ptr<Benchmark> MakeStreamBenchmark() {
  return std::make_unique<StreamBenchmark>();
}

}  // namespace tactus::internal::client
