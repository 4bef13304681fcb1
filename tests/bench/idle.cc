#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "CLI/CLI.hpp"
#include "client/stream/contact_stream.h"
#include "client/stream/frame_encoder.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/skin/layout.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/child_server.h"
#include "tools/common/percentile.h"

namespace tactus::internal::client {
namespace {

using std::chrono::steady_clock;

struct IdleOptions {
  // Empty: a server of our own.
  std::string server;
  int repetitions = 100;
  int silence_ms = 3000;
};

// Notes when the answer to a frame came.
class AnswerClock {
 public:
  void OnResponse(const v1::ClassifyContactResponse& response) {
    const auto now = steady_clock::now();
    const std::lock_guard lock(mutex_);
    if (response.has_answer()) sequence_ = response.answer().sequence();
    time_ = now;
    answered_.notify_one();
  }

  absl::StatusOr<steady_clock::time_point> Await(uint64_t sequence) {
    std::unique_lock lock(mutex_);
    if (!answered_.wait_for(lock, std::chrono::seconds(30),
                            [&] { return sequence_ >= sequence; })) {
      return StreamIdle(30'000);
    }
    return time_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable answered_;
  uint64_t sequence_ = 0;
  steady_clock::time_point time_;
};

// One taxel pressed.
SkinFrame TouchFrame(const SkinLayout& layout, int64_t capture_time_ns) {
  SkinFrame frame;
  frame.capture_time_ns = capture_time_ns;
  frame.u16.assign(layout.taxels(), 0);
  frame.u16[layout.taxels() / 2] = 500;
  return frame;
}

// Milliseconds from sending a frame to its posterior, one per repetition.
absl::StatusOr<std::vector<double>> MeasureIdle(const IdleOptions& options) {
  std::unique_ptr<ChildServer> child;
  std::string address = options.server;
  if (address.empty()) {
    TACTUS_ASSIGN_OR_RETURN(
        child, ChildServer::Start(
                   "tactusd", {"--listen=127.0.0.1:0", "--log-level=warn"}));
    address = child->address();
  }
  SkinInfo info;
  TACTUS_ASSIGN_OR_RETURN(info.layout, LayoutPreset("cody-forearm"));
  info.scale = 0.001;
  v1::StreamConfig config = MakeConfig(info);
  config.set_model("models/no-poses");
  AnswerClock clock;
  TACTUS_ASSIGN_OR_RETURN(
      const auto stream,
      ContactStream::Open(MakeChannel(address), config,
                          [&](const auto& r) { clock.OnResponse(r); }));
  FrameEncoder encoder(info, {});
  std::vector<double> milliseconds;
  // The first one opens the way and does not count.
  for (int i = 0; i <= options.repetitions; ++i) {
    if (i > 0) {
      std::this_thread::sleep_for(
          std::chrono::milliseconds(options.silence_ms));
    }
    encoder.Clear();
    encoder.Add(TouchFrame(info.layout, 1'000'000 * (i + 1)));
    const auto sent = steady_clock::now();
    TACTUS_RETURN_IF_ERROR(stream->Send(encoder.request()));
    TACTUS_ASSIGN_OR_RETURN(const auto answered,
                            clock.Await(encoder.last_sequence()));
    const std::chrono::duration<double, std::milli> delay = answered - sent;
    if (i > 0) milliseconds.push_back(delay.count());
  }
  TACTUS_RETURN_IF_ERROR(stream->Close());
  return milliseconds;
}

class IdleBenchmark : public Benchmark {
 public:
  const char* name() const override { return "idle"; }
  const char* description() const override {
    return "Delay of the first frame after a silence";
  }

  void AddFlags(CLI::App& command) override {
    command.add_option("--server", options_.server,
                       "host:port or unix:path; else a server that it starts");
    command.add_option("--repetitions", options_.repetitions, "How often")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    command
        .add_option("--silence-ms", options_.silence_ms,
                    "Length of the silence")
        ->check(CLI::Range(0, 3'600'000))
        ->capture_default_str();
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    IdleOptions options = options_;
    if (quick) options.repetitions = std::min(options.repetitions, 5);
    if (quick) options.silence_ms = std::min(options.silence_ms, 200);
    TACTUS_ASSIGN_OR_RETURN(const auto milliseconds, MeasureIdle(options));
    std::vector<BenchRow> rows;
    const std::pair<const char*, double> shares[] = {
        {"p50", 0.5}, {"p90", 0.9}, {"p99", 0.99}, {"max", 1}};
    for (const auto& [name, share] : shares) {
      rows.push_back({.name = std::string("idle/first_frame_") + name,
                      .unit = "ms",
                      .ours = Percentile(milliseconds, share)});
    }
    return rows;
  }

 private:
  IdleOptions options_;
};

}  // namespace

std::unique_ptr<Benchmark> MakeIdleBenchmark() {
  return std::make_unique<IdleBenchmark>();
}

}  // namespace tactus::internal::client
