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
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/base/thread_priority.h"
#include "tools/load/event_loop.h"
#include "tools/load/load_stream.h"
#include "tools/load/load_tally.h"

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
// The seed's stream for the robots' last messages; Schedule uses the seed
// itself.
constexpr uint64_t kEndsStream = 1;
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
    shared_.cadence = options.cadence;
  }

  LoadReport Run() {
    OpenAll();
    const double cpu_s = ProcessSeconds();
    const auto start = steady_clock::now();
    SendAll();
    AwaitAnswers();
    const std::chrono::duration<double> elapsed = steady_clock::now() - start;
    shared_.tally.elapsed_s = elapsed.count();
    shared_.tally.cpu_s = ProcessSeconds() - cpu_s;
    CountAnswers();
    CloseAll();
    return ReportOf(shared_.tally);
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
    const std::vector<uint64_t> ends = DrawEnds(messages);
    for (uint64_t message = 0; message <= messages; ++message) {
      for (LoadStream* stream : senders_) {
        const uint64_t end = ends[stream->robot()];
        if (message > end || (message == end && shared_.answers_all())) {
          continue;
        }
        const int64_t due_ns = schedule.DueNs(stream->robot(), message);
        WaitUntilDue(due_ns);
        if (message < end) {
          stream->Offer();
        } else {
          stream->Close(due_ns);
        }
      }
    }
  }

  // How many messages each robot sends. If only the last answer of a stream
  // shows that all was processed, robots leave one by one in the last tenth of
  // the test: a server that ends all streams at once would be slow to do so.
  std::vector<uint64_t> DrawEnds(uint64_t messages) const {
    std::vector<uint64_t> ends(options_.robots, messages);
    if (shared_.answers_all()) return ends;
    Random random = Random::ForStream(options_.seed, kEndsStream);
    for (uint64_t& end : ends) end -= random.Index(messages / 10 + 1);
    return ends;
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
    // The last message is answered even if answers were superseded.
    const auto all_answered = [this] {
      return std::all_of(senders_.begin(), senders_.end(),
                         [](const LoadStream* stream) {
                           return stream->processed() >= stream->offered();
                         });
    };
    loop_.HandleUntil(all_answered, kAnswerTimeout);
  }

  void CountAnswers() {
    LoadTally& tally = shared_.tally;
    for (const auto& stream : streams_) {
      tally.sent += stream->offered();
      tally.answered += stream->answered();
      tally.answers += stream->answers();
    }
  }

  void CloseAll() {
    for (const auto& stream : streams_) stream->Close();
    const auto all_ended = [this] { return shared_.ended == options_.robots; };
    if (!loop_.HandleUntil(all_ended, kCloseTimeout)) {
      for (const auto& stream : streams_) stream->Cancel();
      loop_.HandleUntil(all_ended, kForEver);
    }
    LoadTally& tally = shared_.tally;
    tally.robots = options_.robots;
    for (const auto& stream : streams_) {
      tally.superseded += stream->superseded();
      tally.unannounced += stream->unannounced();
      if (!stream->accepted()) {
        ++tally.refused;
      } else if (!stream->status().ok()) {
        ++tally.failed;
      }
      if (!stream->status().ok() && tally.first_error.empty()) {
        tally.first_error = stream->status().ToString();
      }
    }
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
