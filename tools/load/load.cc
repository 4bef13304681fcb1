#include "tools/load/load.h"

#include <sys/prctl.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>
#include <vector>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/thread_priority.h"
#include "tools/load/event_loop.h"
#include "tools/load/load_stream.h"

namespace tactus::internal::client {
namespace {

using std::chrono::nanoseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

// Messages due within this time leave together, so that waking up costs
// little; it counts as delay.
constexpr int64_t kTickNs = 100'000;
// Between the last stream's opening and the first message.
constexpr int64_t kLeadNs = 20'000'000;
constexpr seconds kOpenTimeout(30);
// For answers after the last message.
constexpr seconds kAnswerTimeout(3);
constexpr seconds kCloseTimeout(10);
// Cancelled streams end.
constexpr std::chrono::hours kForEver(1);

absl::Status Check(const LoadOptions& options) {
  if (options.robots < 1) {
    return InvalidConfig("robots", options.robots, "at least 1");
  }
  if (!(options.rate_hz > 0 && options.rate_hz <= limits::kMaxSampleRateHz)) {
    return InvalidConfig("rate", options.rate_hz, "a rate a skin can have");
  }
  if (!(options.seconds > options.warm_up_seconds)) {
    return InvalidConfig("seconds", options.seconds, "more than the warm-up");
  }
  return absl::OkStatus();
}

// Processor time of this process, s.
double ProcessSeconds() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  const auto in_seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * time.tv_usec;
  };
  return in_seconds(usage.ru_utime) + in_seconds(usage.ru_stime);
}

class LoadTest {
 public:
  LoadTest(const LoadOptions& options, const FrameScript& script)
      : options_(options) {
    shared_.script = &script;
    shared_.frames_per_message = options.frames_per_message;
  }

  LoadReport Run() {
    OpenAll();
    const double cpu = ProcessSeconds();
    const auto start = steady_clock::now();
    SendAll();
    AwaitAnswers();
    const std::chrono::duration<double> elapsed = steady_clock::now() - start;
    LoadReport report = CloseAll(ProcessSeconds() - cpu, elapsed.count());
    return report;
  }

 private:
  void OpenAll() {
    connections_ = options_.connections == 0
                       ? options_.robots
                       : std::min(options_.connections, options_.robots);
    ChannelOptions own = options_.channel;
    own.share_connection = false;
    std::vector<std::shared_ptr<grpc::Channel>> channels;
    for (int i = 0; i < connections_; ++i) {
      channels.push_back(MakeChannel(options_.address, own));
    }
    for (int i = 0; i < options_.robots; ++i) {
      streams_.push_back(std::make_unique<LoadStream>(&shared_, i));
      streams_.back()->Open(channels[i % connections_], loop_.queue());
    }
    loop_.HandleUntil([this] { return shared_.settled == options_.robots; },
                      kOpenTimeout);
    for (const auto& stream : streams_) {
      if (stream->accepted()) senders_.push_back(stream.get());
    }
  }

  void SendAll() {
    // Robots do not share the server's processors: sleeps end when asked to,
    // not 50 us later or when a training on this machine leaves a processor.
    prctl(PR_SET_TIMERSLACK, 1);
    SetThreadPriority(ThreadPriority::kPrompt);
    const double period_ns =
        1e9 * options_.frames_per_message / options_.rate_hz;
    const auto period = static_cast<int64_t>(std::llround(period_ns));
    const int64_t start_ns = LoadClockNs() + kLeadNs;
    const Schedule schedule(options_.robots, start_ns, period, options_.seed);
    schedule_ = std::make_unique<Schedule>(schedule);
    shared_.schedule = schedule_.get();
    shared_.measure_from_ns =
        start_ns + static_cast<int64_t>(options_.warm_up_seconds * 1e9);
    tick_ns_ = start_ns;
    const auto messages = static_cast<uint64_t>(
        std::max(1.0, options_.seconds * 1e9 / period_ns));
    for (uint64_t message = 0; message < messages; ++message) {
      for (LoadStream* stream : senders_) {
        WaitUntilDue(schedule.DueNs(stream->robot(), message));
        stream->Offer();
      }
    }
  }

  // Takes what has come meanwhile, once a tick, even when late.
  void WaitUntilDue(int64_t due_ns) {
    if (due_ns <= tick_ns_) return;
    const int64_t now_ns = LoadClockNs();
    const int64_t ticks =
        (std::max(due_ns, now_ns) - tick_ns_ + kTickNs - 1) / kTickNs;
    tick_ns_ += ticks * kTickNs;
    std::this_thread::sleep_until(
        steady_clock::time_point(nanoseconds(tick_ns_)));
    loop_.HandleReady(connections_);
  }

  void AwaitAnswers() {
    const auto all_answered = [this] {
      return std::all_of(senders_.begin(), senders_.end(),
                         [](const LoadStream* stream) {
                           return stream->answered() + stream->superseded() >=
                                  stream->offered();
                         });
    };
    loop_.HandleUntil(all_answered, kAnswerTimeout);
  }

  LoadReport CloseAll(double cpu_seconds, double elapsed) {
    for (const auto& stream : streams_) stream->Close();
    const auto all_ended = [this] { return shared_.ended == options_.robots; };
    if (!loop_.HandleUntil(all_ended, kCloseTimeout)) {
      for (const auto& stream : streams_) stream->Cancel();
      loop_.HandleUntil(all_ended, kForEver);
    }
    LoadReport report;
    report.robots = options_.robots;
    for (const auto& stream : streams_) {
      report.sent += stream->offered();
      report.answered += stream->answered();
      report.superseded += stream->superseded();
      if (!stream->accepted()) {
        ++report.refused;
      } else if (!stream->status().ok()) {
        ++report.failed;
      }
      if (!stream->status().ok() && report.first_error.empty()) {
        report.first_error = stream->status().ToString();
      }
    }
    const auto ms = [](const LatencyHistogram& histogram, double share) {
      return static_cast<double>(histogram.PercentileNs(share)) / 1e6;
    };
    report.p50_ms = ms(shared_.answer_delay, 0.5);
    report.p90_ms = ms(shared_.answer_delay, 0.9);
    report.p99_ms = ms(shared_.answer_delay, 0.99);
    report.p999_ms = ms(shared_.answer_delay, 0.999);
    report.max_ms = ms(shared_.answer_delay, 1);
    report.send_p99_ms = ms(shared_.send_delay, 0.99);
    report.answers_per_s = static_cast<double>(report.answered) / elapsed;
    report.cpu_share = cpu_seconds / elapsed;
    return report;
  }

  const LoadOptions& options_;
  LoadShared shared_;
  int connections_ = 0;
  // How far sending has come.
  int64_t tick_ns_ = 0;
  std::unique_ptr<Schedule> schedule_;
  std::vector<std::unique_ptr<LoadStream>> streams_;
  // Those the server accepted, in the order of their phases.
  std::vector<LoadStream*> senders_;
  EventLoop loop_;
};

}  // namespace

absl::StatusOr<FrameScript> MakeScript(const LoadOptions& options) {
  return FrameScript::Create({.seed = options.seed,
                              .frames_per_message = options.frames_per_message,
                              .sparse = options.sparse,
                              .untouched_seconds = options.untouched_seconds});
}

absl::StatusOr<LoadReport> RunLoad(const LoadOptions& options,
                                   const FrameScript& script) {
  TACTUS_RETURN_IF_ERROR(Check(options));
  return std::make_unique<LoadTest>(options, script)->Run();
}

absl::StatusOr<LoadReport> RunLoad(const LoadOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(const FrameScript script, MakeScript(options));
  return RunLoad(options, script);
}

}  // namespace tactus::internal::client
