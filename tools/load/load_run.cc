#include "tools/load/load_run.h"

#include <sys/prctl.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/base/thread_priority.h"

namespace tactus::internal::client {
namespace {

using std::chrono::nanoseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

// Messages due within this time leave together, so that waking up costs
// little; it counts as delay.
constexpr int64_t kTickNs = 500'000;
// A slow reader takes one answer in this time.
constexpr int64_t kSlowReadNs = 1'000'000'000;
constexpr seconds kOpenTimeout(30);
// For answers after the last message.
constexpr seconds kAnswerTimeout(3);
constexpr seconds kCloseTimeout(10);
// The seed's stream for the robots' last messages; Schedule uses the seed
// itself, and robots the streams of their numbers.
constexpr uint64_t kEndsStream = uint64_t{1} << 40;
// Cancelled streams end.
constexpr std::chrono::hours kForEver(1);

// Processor time of this process, s.
double ProcessSeconds() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  const auto in_seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * time.tv_usec;
  };
  return in_seconds(usage.ru_utime) + in_seconds(usage.ru_stime);
}

}  // namespace

absl::Status LoadRun::Check(const LoadOptions& options) {
  if (options.servers.empty()) {
    return InvalidConfig("servers", 0, "at least 1");
  }
  if (options.robots < 1) {
    return InvalidConfig("robots", options.robots, "at least 1");
  }
  if (!(options.rate_hz > 0 && options.rate_hz <= limits::kMaxSampleRateHz)) {
    return InvalidConfig("rate", options.rate_hz, "a rate a skin can have");
  }
  if (!(options.seconds > options.warm_up_seconds)) {
    return InvalidConfig("seconds", options.seconds, "more than the warm-up");
  }
  if (options.part < 0 || options.part >= options.parts) {
    return InvalidConfig("part", options.part, "0 to parts - 1");
  }
  return absl::OkStatus();
}

LoadRun::LoadRun(const LoadOptions& options, const FrameScript& script)
    : options_(options) {
  shared_.script = &script;
  shared_.frames_per_message = options.frames_per_message;
  shared_.cadence = options.cadence;
  const double period_ns = 1e9 * options.frames_per_message / options.rate_hz;
  period_ns_ = std::llround(period_ns);
  messages_ =
      static_cast<uint64_t>(std::max(1.0, options.seconds * 1e9 / period_ns));
}

absl::Status LoadRun::Open() {
  TACTUS_RETURN_IF_ERROR(FindServers());
  OpenRobots();
  loop_.HandleUntil([this] { return shared_.settled == shared_.opened; },
                    kOpenTimeout);
  for (const auto& robot : robots_) {
    if (!robot->accepted()) continue;
    senders_.push_back(robot.get());
    if (robot->number() < options_.slow_readers) slow_.push_back(robot.get());
  }
  return absl::OkStatus();
}

absl::Status LoadRun::FindServers() {
  for (const std::string& address : options_.servers) {
    TACTUS_ASSIGN_OR_RETURN(places_.emplace_back(),
                            ServerPlace::Find(address, options_.tls_roots));
  }
  return absl::OkStatus();
}

void LoadRun::OpenRobots() {
  const std::vector<uint64_t> ends = DrawEnds();
  const int servers = static_cast<int>(places_.size());
  const int robots =
      (options_.robots - options_.part + options_.parts - 1) / options_.parts;
  const int share =
      (options_.connections + options_.parts - 1) / options_.parts;
  if (options_.connections > 0) {
    connections_.resize(std::min(std::max(share, servers), robots));
  }
  const double stream_messages =
      options_.arrivals_seconds * 1e9 / static_cast<double>(period_ns_);
  for (int i = options_.part; i < options_.robots; i += options_.parts) {
    const size_t place = robots_.size();
    const auto connect = [this, i, place, servers] {
      return connections_.empty() ? NewConnection(i % servers)
                                  : Shared(place % connections_.size());
    };
    robots_.push_back(std::make_unique<LoadRobot>(
        &shared_,
        LoadRobot::Options{.number = i,
                           .messages = ends[i],
                           .stream_messages = stream_messages,
                           .reads_slowly = i < options_.slow_readers,
                           .seed = options_.seed},
        connect));
    robots_.back()->Open();
  }
}

std::shared_ptr<GrpcConnection> LoadRun::Shared(size_t place) {
  std::shared_ptr<GrpcConnection>& shared = connections_[place];
  if (shared == nullptr || !shared->takes_calls()) {
    shared = NewConnection((options_.part + static_cast<int>(place)) %
                           static_cast<int>(places_.size()));
  }
  return shared;
}

std::shared_ptr<GrpcConnection> LoadRun::NewConnection(int server) {
  return std::make_shared<GrpcConnection>(&loop_, places_[server]);
}

const LoadTally& LoadRun::Send(int64_t start_ns) {
  const double cpu_s = ProcessSeconds();
  const auto start = steady_clock::now();
  SendAll(start_ns);
  AwaitAnswers();
  const std::chrono::duration<double> elapsed = steady_clock::now() - start;
  LoadTally& tally = shared_.tally;
  tally.elapsed_s = elapsed.count();
  tally.cpu_s = ProcessSeconds() - cpu_s;
  for (const auto& robot : robots_) robot->CountAnswers();
  CloseAll();
  for (const auto& robot : robots_) robot->CountEnds();
  tally.AddSlow(shared_.slow_tally);
  return tally;
}

void LoadRun::SendAll(int64_t start_ns) {
  // Robots do not share the server's processors: sleeps end when asked to,
  // not 50 us later or when a training on this machine leaves a processor.
  prctl(PR_SET_TIMERSLACK, 1);
  SetThreadPriority(ThreadPriority::kPrompt);
  schedule_ = std::make_unique<Schedule>(options_.robots, start_ns, period_ns_,
                                         options_.seed);
  shared_.schedule = schedule_.get();
  shared_.measure_from_ns =
      start_ns + static_cast<int64_t>(options_.warm_up_seconds * 1e9);
  tick_ns_ = start_ns;
  for (uint64_t message = 0; message <= messages_; ++message) {
    for (LoadRobot* robot : senders_) {
      const uint64_t end = robot->messages();
      if (message > end || (message == end && shared_.answers_all())) continue;
      const int64_t due_ns = schedule_->DueNs(robot->number(), message);
      WaitUntilDue(due_ns);
      if (message < end) {
        robot->Offer(message, due_ns);
      } else {
        robot->Close(due_ns);
      }
    }
  }
}

// If only the last answer of a stream shows that all was processed, robots
// leave one by one in the last tenth of the test: a server that ends all
// streams at once would be slow to do so.
std::vector<uint64_t> LoadRun::DrawEnds() const {
  std::vector<uint64_t> ends(options_.robots, messages_);
  if (shared_.answers_all()) return ends;
  Random random = Random::ForStream(options_.seed, kEndsStream);
  for (uint64_t& end : ends) end -= random.Index(messages_ / 10 + 1);
  return ends;
}

void LoadRun::WaitUntilDue(int64_t due_ns) {
  if (due_ns <= tick_ns_) return;
  loop_.Flush();
  const int64_t now_ns = LoadClockNs();
  const int64_t ticks =
      (std::max(due_ns, now_ns) - tick_ns_ + kTickNs - 1) / kTickNs;
  tick_ns_ += ticks * kTickNs;
  std::this_thread::sleep_until(
      steady_clock::time_point(nanoseconds(tick_ns_)));
  ReadSlowly(tick_ns_);
  loop_.HandleReady();
}

void LoadRun::ReadSlowly(int64_t now_ns) {
  if (slow_.empty() || now_ns < next_slow_read_ns_) return;
  for (LoadRobot* robot : slow_) robot->ReadNext();
  next_slow_read_ns_ = now_ns + kSlowReadNs;
}

void LoadRun::AwaitAnswers() {
  for (LoadRobot* robot : slow_) robot->ReadAll();
  // The last message is answered even if answers were superseded.
  const auto all_processed = [this] {
    return std::ranges::all_of(
        senders_, [](const LoadRobot* robot) { return robot->processed(); });
  };
  loop_.HandleUntil(all_processed, kAnswerTimeout);
}

void LoadRun::CloseAll() {
  for (const auto& robot : robots_) robot->Close();
  const auto all_ended = [this] { return shared_.ended == shared_.opened; };
  if (loop_.HandleUntil(all_ended, kCloseTimeout)) return;
  for (const auto& robot : robots_) robot->Cancel();
  loop_.HandleUntil(all_ended, kForEver);
}

}  // namespace tactus::internal::client
