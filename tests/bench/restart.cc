#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/strings/str_cat.h"
#include "client/stream/channel.h"
#include "client/stream/frame_encoder.h"
#include "client/stream/resumable_stream.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/skin/layout.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/child_server.h"
#include "tests/bench/haproxy.h"
#include "tools/common/percentile.h"

namespace tactus::internal::client {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

// A contact of two seconds; the server is killed in its middle.
constexpr int kFrames = 200;
constexpr int kKilledAt = 100;
constexpr milliseconds kPeriod{10};

struct RestartOptions {
  int kills = 5;
  // RestartSec of deploy/tactusd.service.
  int restart_after_ms = 50;
};

// The longest time between two answers that follow each other.
class GapClock {
 public:
  void OnResponse(const v1::ClassifyContactResponse& response) {
    if (!response.has_answer()) return;
    const auto now = steady_clock::now();
    const std::lock_guard lock(mutex_);
    if (answers_++ > 0) longest_ = std::max(longest_, now - last_);
    last_ = now;
  }
  double longest_ms() {
    const std::lock_guard lock(mutex_);
    return std::chrono::duration<double, std::milli>(longest_).count();
  }

 private:
  std::mutex mutex_;
  int answers_ = 0;
  steady_clock::time_point last_;
  steady_clock::duration longest_{0};
};

// A robot's contact, and the server that is killed in the middle of it.
class KilledContact {
 public:
  KilledContact(const RestartOptions& options, bool proxied)
      : options_(options), proxied_(proxied), port_(FreePort()) {}

  absl::Status Run(bool kill) {
    TACTUS_RETURN_IF_ERROR(StartServer());
    std::unique_ptr<Haproxy> proxy;
    std::string address = server_->address();
    if (proxied_) {
      TACTUS_ASSIGN_OR_RETURN(proxy, Haproxy::Start(address));
      address = proxy->address();
    }
    SkinInfo info;
    TACTUS_ASSIGN_OR_RETURN(info.layout, LayoutPreset("cody-forearm"));
    info.scale = 0.001;
    v1::StreamConfig config = MakeConfig(info);
    config.set_model("models/no-poses");
    TACTUS_ASSIGN_OR_RETURN(
        const auto stream,
        ResumableStream::Open(MakeChannel(address), config,
                              [&](const auto& r) { clock_.OnResponse(r); }));
    FrameEncoder encoder(info, {});
    auto due = steady_clock::now();
    absl::Status restarted;
    std::thread restart;
    for (int t = 0; t < kFrames; ++t) {
      if (kill && t == kKilledAt) {
        restart = std::thread([&] { restarted = KillAndStart(); });
      }
      encoder.Clear();
      encoder.Add(PressedFrame(info.layout, t));
      const absl::Status sent = stream->Send(encoder.request());
      if (!sent.ok()) {
        if (restart.joinable()) restart.join();
        return sent;
      }
      due += kPeriod;
      std::this_thread::sleep_until(due);
    }
    if (restart.joinable()) restart.join();
    TACTUS_RETURN_IF_ERROR(restarted);
    TACTUS_ASSIGN_OR_RETURN(const v1::Answer answer, stream->EndTrial());
    const auto& probability = answer.contacts(0).probability();
    probability_.assign(probability.begin(), probability.end());
    resumed_ = stream->statistics().resumed;
    return stream->Close();
  }

  double gap_ms() { return clock_.longest_ms(); }
  uint64_t resumed() const { return resumed_; }
  const std::vector<float>& probability() const { return probability_; }

 private:
  absl::Status StartServer() {
    TACTUS_ASSIGN_OR_RETURN(
        server_, ChildServer::Start("tactusd",
                                    {absl::StrCat("--listen=127.0.0.1:", port_),
                                     "--log-level=error"}));
    return absl::OkStatus();
  }
  absl::Status KillAndStart() {
    server_->Kill();
    std::this_thread::sleep_for(milliseconds(options_.restart_after_ms));
    return StartServer();
  }
  static SkinFrame PressedFrame(const SkinLayout& layout, int t) {
    SkinFrame frame;
    frame.capture_time_ns = kPeriod.count() * 1'000'000 * t;
    frame.u16.assign(layout.taxels(), 0);
    for (const int taxel : {180, 181, 204, 205}) {
      frame.u16[taxel] = static_cast<uint16_t>(20 * t);
    }
    return frame;
  }

  const RestartOptions options_;
  const bool proxied_;
  const int port_;
  GapClock clock_;
  std::unique_ptr<ChildServer> server_;
  std::vector<float> probability_;
  uint64_t resumed_ = 0;
};

absl::StatusOr<std::vector<BenchRow>> MeasureRestart(
    const RestartOptions& options, bool proxied) {
  KilledContact whole(options, proxied);
  TACTUS_RETURN_IF_ERROR(whole.Run(/*kill=*/false));
  std::vector<double> gaps;
  for (int i = 0; i < options.kills; ++i) {
    KilledContact killed(options, proxied);
    TACTUS_RETURN_IF_ERROR(killed.Run(/*kill=*/true));
    if (killed.resumed() == 0) return NumericalFailure("no stream was resumed");
    if (killed.probability() != whole.probability()) {
      return NumericalFailure("a resumed contact has other probabilities");
    }
    gaps.push_back(killed.gap_ms());
  }
  const std::string name = proxied ? "restart/proxied_gap_" : "restart/gap_";
  return std::vector<BenchRow>{
      {.name = name + "p50", .unit = "ms", .ours = Percentile(gaps, 0.5)},
      {.name = name + "max", .unit = "ms", .ours = Percentile(gaps, 1)},
      {.name = proxied ? "restart/proxied_gap_without" : "restart/gap_without",
       .unit = "ms",
       .ours = whole.gap_ms()}};
}

class RestartBenchmark : public Benchmark {
 public:
  const char* name() const override { return "restart"; }
  const char* description() const override {
    return "How long answers stop when the server is killed";
  }

  void AddFlags(CLI::App& command) override {
    command.add_option("--kills", options_.kills, "How often")
        ->check(CLI::Range(1, 10'000))
        ->capture_default_str();
    command
        .add_option("--restart-after-ms", options_.restart_after_ms,
                    "Time from the kill to the next start")
        ->check(CLI::Range(0, 10'000))
        ->capture_default_str();
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    RestartOptions options = options_;
    if (quick) options.kills = 1;
    std::vector<BenchRow> rows;
    for (const bool proxied : {false, true}) {
      if (proxied && !Haproxy::Installed()) break;
      TACTUS_ASSIGN_OR_RETURN(const auto more,
                              MeasureRestart(options, proxied));
      rows.insert(rows.end(), more.begin(), more.end());
    }
    return rows;
  }

 private:
  RestartOptions options_;
};

}  // namespace

std::unique_ptr<Benchmark> MakeRestartBenchmark() {
  return std::make_unique<RestartBenchmark>();
}

}  // namespace tactus::internal::client
