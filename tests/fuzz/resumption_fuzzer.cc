// A robot whose stream is lost at any place, again and again, also amid several
// contacts: with StreamHistory it gets the answers of one stream, bit for bit,
// whatever the skin, the cadence and the packing of frames.
#include <fuzzer/FuzzedDataProvider.h>

#include <memory>
#include <string>
#include <vector>

#include "client/stream/stream_history.h"
#include "core/base/limits.h"
#include "server/session/stream_session.h"
#include "tests/fuzz/any_skin.h"
#include "tests/server/support/test_models.h"

namespace {

using tactus::internal::client::StreamHistory;
using tactus::internal::server::StreamSession;
using Request = tactus::v1::ClassifyContactRequest;

#define REQUIRE(condition) \
  if (!(condition)) __builtin_trap()

constexpr int kMaxMessages = 60;

const tactus::internal::testing::TestModels& Models() {
  static const auto* const models = new tactus::internal::testing::TestModels();
  return *models;
}

Request EndOfTrial() {
  Request request;
  request.mutable_end_of_trial();
  return request;
}

// Trials of frames in order, with lost ones, and the end of the last one.
std::vector<Request> Script(FuzzedDataProvider& data,
                            const tactus::v1::StreamConfig& config) {
  tactus::internal::fuzz::Presses presses(config);
  std::vector<Request> script;
  uint64_t sequence = 1;
  while (data.remaining_bytes() > 40 && script.size() < kMaxMessages) {
    if (data.ConsumeIntegralInRange(0, 15) == 0) script.push_back(EndOfTrial());
    if (data.ConsumeIntegralInRange(0, 9) == 0) {
      sequence += data.ConsumeIntegralInRange(1, 80);
    }
    auto* batch = script.emplace_back().mutable_frames();
    const auto count = data.ConsumeIntegralInRange<uint32_t>(1, 12);
    batch->set_first_sequence(sequence);
    batch->set_first_capture_time_ns(static_cast<int64_t>(sequence) *
                                     10'000'000);
    batch->set_frame_count(count);
    sequence += count;
    const bool sparse = data.ConsumeBool();
    for (uint32_t i = 0; i < count; ++i) {
      if (data.ConsumeIntegralInRange(0, 2) == 0) presses.Change(data);
      presses.AppendTo(sparse, batch);
      if (!config.with_poses()) continue;
      for (int k = 0; k < 3; ++k) {
        batch->add_poses(1e-3 * data.ConsumeIntegral<int8_t>());
      }
      for (double q : {0.0, 0.0, 0.0, 1.0}) batch->add_poses(q);
    }
  }
  script.push_back(EndOfTrial());
  return script;
}

std::unique_ptr<StreamSession> Open(const tactus::v1::StreamConfig& config,
                                    tactus::v1::StreamStarted* started) {
  auto session = std::make_unique<StreamSession>(
      &Models(), StreamSession::Options{.stream_id = "1"});
  Request request;
  *request.mutable_config() = config;
  if (!session->OnRequest(request).ok()) return nullptr;
  *started = session->responses().StartWrite(0)->started();
  session->responses().FinishWrite();
  return session;
}

// Without the times of the server.
std::string Bits(tactus::v1::Answer answer) {
  answer.mutable_diagnostics()->clear_server_compute_ns();
  answer.mutable_diagnostics()->clear_queue_ns();
  return answer.SerializeAsString();
}

class Robot {
 public:
  Robot(FuzzedDataProvider& data, const tactus::v1::StreamConfig& config,
        const tactus::v1::StreamStarted& started)
      : data_(data),
        config_(config),
        history_(config, started, tactus::internal::limits::kMaxReplayBytes) {
    Connect();
  }

  void Play(const Request& request) {
    if (Loses()) Resume();
    if (request.has_frames()) {
      REQUIRE(history_.Add(request.frames()));
      if (Loses()) {
        Resume();
      } else {
        history_.SentAll();
        Send(request);
      }
    } else {
      history_.EndTrial();
      if (Loses()) {
        Resume();
      } else {
        Send(request);
      }
    }
    while (!Receive() || history_.ending()) Resume();
  }

  const std::vector<std::string>& answers() const { return answers_; }

 private:
  // Never more than once the bytes are used up.
  bool Loses() { return data_.ConsumeIntegralInRange(0, 15) == 15; }

  void Connect() {
    tactus::v1::StreamStarted started;
    session_ = Open(config_, &started);
    REQUIRE(session_ != nullptr);
  }

  void Send(const Request& request) {
    REQUIRE(session_->OnRequest(request).ok());
  }

  // Takes the answers, or some of them if the stream is lost.
  bool Receive() {
    const bool lost = Loses();
    size_t left = lost ? data_.ConsumeIntegralInRange(0, 3) : SIZE_MAX;
    while (left-- > 0) {
      const auto* response = session_->responses().StartWrite(0);
      if (response == nullptr) break;
      const auto* shown = history_.Take(*response);
      if (shown != nullptr) answers_.push_back(Bits(shown->answer()));
      session_->responses().FinishWrite();
    }
    return !lost;
  }

  void Resume() {
    do {
      Connect();
      REQUIRE(history_.BeginStream() == StreamHistory::Beginning::kKnown);
    } while (!SendAll());
  }

  bool SendAll() {
    Request request;
    while (history_.NextUnsent(request.mutable_frames())) {
      Send(request);
      if (!Receive()) return false;
    }
    if (!history_.ending()) return true;
    Send(EndOfTrial());
    return Receive();
  }

  FuzzedDataProvider& data_;
  const tactus::v1::StreamConfig& config_;
  std::unique_ptr<StreamSession> session_;
  StreamHistory history_;
  std::vector<std::string> answers_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  FuzzedDataProvider data(bytes, size);
  const tactus::v1::StreamConfig config =
      tactus::internal::fuzz::AnyConfig(data);
  tactus::v1::StreamStarted started;
  const auto session = Open(config, &started);
  if (session == nullptr) return 0;
  const std::vector<Request> script = Script(data, config);
  std::vector<std::string> want;
  for (const Request& request : script) {
    REQUIRE(session->OnRequest(request).ok());
    while (const auto* response = session->responses().StartWrite(0)) {
      if (response->has_answer()) want.push_back(Bits(response->answer()));
      session->responses().FinishWrite();
    }
  }
  Robot robot(data, config, started);
  for (const Request& request : script) robot.Play(request);
  REQUIRE(robot.answers() == want);
  return 0;
}
