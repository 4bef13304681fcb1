// StreamHistory against StreamSession: a robot whose stream is lost at any
// place gets the answers of one stream, bit for bit.
#include "client/stream/stream_history.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/limits.h"
#include "core/base/random.h"
#include "core/skin/layout_proto.h"
#include "gtest/gtest.h"
#include "server/session/stream_session.h"
#include "tests/server/support/requests.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/small_model.h"

namespace tactus::internal::client {
namespace {

using server::StreamSession;
using testing::Counts;

// One model for 100 Hz, and "models/fast" for 1,000 Hz.
class OneModel : public server::ModelSource {
 public:
  OneModel() {
    Model model = testing::SmallModel();
    testing::AddLstms(1, model);
    model_ = *CompiledModel::Create(model);
    model.inputs.sample_rate_hz = 1000;
    fast_ = *CompiledModel::Create(model);
  }
  absl::StatusOr<server::PinnedModel> Find(absl::string_view name,
                                           absl::string_view) const override {
    return server::PinnedModel{name == "models/fast" ? fast_ : model_,
                               "models/default/versions/1",
                               std::string(64, 'a')};
  }

 private:
  std::shared_ptr<const CompiledModel> model_;
  std::shared_ptr<const CompiledModel> fast_;
};

const OneModel& Models() {
  static const auto* const models = new OneModel();
  return *models;
}

v1::StreamConfig SmallConfig(bool with_poses, bool light_touch,
                             double rate_hz = 100, int columns = 6) {
  SkinLayout layout = *LayoutPreset("cody-forearm");
  layout.rows = 4;
  layout.columns = columns;
  layout.name = "small";
  if (light_touch) {
    layout.light_touch = LightTouch{.window_s = 0.05,
                                    .rows = 2,
                                    .columns = 2,
                                    .contact_threshold = 0.05,
                                    .onset_threshold = 0.08};
  }
  v1::StreamConfig config;
  *config.mutable_geometry() = LayoutToProto(layout);
  config.set_taxel_type(v1::TAXEL_TYPE_UINT16);
  config.set_scale(testing::kStep);
  config.set_sample_rate_hz(rate_hz);
  config.set_with_poses(with_poses);
  if (rate_hz == 1000) config.set_model("models/fast");
  config.set_release_after_ms(rate_hz == 1000 ? 6 : 60);
  config.set_with_taxels(true);
  config.set_with_diagnostics(true);
  return config;
}

// One object: touches and pauses of any length.
class Toucher {
 public:
  // The load in the next frame; 0 in a pause.
  double Next(double rate_hz, Random& random) {
    if (left_-- <= 0) {
      touched_ = !touched_;
      // Pauses longer and shorter than the 0.2 s before an onset.
      const int longest = rate_hz == 1000 ? 400 : 60;
      left_ = static_cast<int>(random.Index(touched_ ? 40 : longest));
      newton_ = 0;
    }
    newton_ += random.Uniform(0, 0.2);
    return touched_ ? newton_ : 0;
  }

 private:
  int left_ = 0;
  bool touched_ = false;
  double newton_ = 0;
};

// What a robot sends: trials of touches, with lost frames, in messages of up to
// `batch` frames. A wide skin is touched by two objects. The right one spreads
// as its load grows, until it joins the left one around the seam. A wider one
// is touched by two more.
std::vector<v1::ClassifyContactRequest> Script(const v1::StreamConfig& config,
                                               int trials, int frames,
                                               uint32_t batch, uint64_t seed) {
  Random random(seed);
  std::vector<v1::ClassifyContactRequest> script;
  uint64_t sequence = 0;
  double way = 0;
  const auto period_ns = static_cast<int64_t>(1e9 / config.sample_rate_hz());
  for (int trial = 0; trial < trials; ++trial) {
    Toucher left;
    Toucher right;
    Toucher third;
    Toucher fourth;
    const auto columns = static_cast<int>(config.geometry().columns());
    v1::FrameBatch* open = nullptr;
    for (int t = 0; t < frames; ++t) {
      const double on_left = left.Next(config.sample_rate_hz(), random);
      const double on_right =
          columns < 12 ? 0 : right.Next(config.sample_rate_hz(), random);
      const auto on_more = [&](Toucher& toucher) {
        return columns < 30 ? 0 : toucher.Next(config.sample_rate_hz(), random);
      };
      const double on_third = on_more(third);
      const double on_fourth = on_more(fourth);
      ++sequence;
      const bool lost = random.Index(25) == 0;
      if (lost) sequence += 1 + random.Index(random.Index(5) == 0 ? 300 : 5);
      if (lost || open == nullptr || open->frame_count() >= batch ||
          random.Index(4) == 0) {
        open = script.emplace_back().mutable_frames();
        open->set_first_sequence(sequence);
        open->set_first_capture_time_ns(
            static_cast<int64_t>(sequence) * period_ns +
            static_cast<int64_t>(random.Index(period_ns / 10)));
      }
      open->set_frame_count(open->frame_count() + 1);
      for (int taxel = 0; taxel < 4 * columns; ++taxel) {
        double value = random.Uniform(0, 0.01);
        const int column = taxel % columns;
        if (column < 3) value += on_left * random.Uniform();
        if (column >= 7 && column < 9 + 2 * on_right) {
          value += on_right * random.Uniform();
        }
        if (on_third > 0 && column >= 19 && column < 21) value += on_third;
        if (on_fourth > 0 && column >= 24 && column < 27) value += on_fourth;
        const auto count = static_cast<uint16_t>(value / testing::kStep);
        open->mutable_taxels()->append(reinterpret_cast<const char*>(&count),
                                       sizeof(count));
      }
      if (!config.with_poses()) continue;
      way += 1e-4 * random.Uniform();
      Pose pose;
      pose.position = {1e-5 * random.Gaussian(), 0.1, way};
      testing::AddPose(pose, open);
    }
    script.push_back(testing::EndOfTrialRequest());
    // A trial without frames.
    if (random.Index(3) == 0) script.push_back(testing::EndOfTrialRequest());
  }
  return script;
}

// A server's end of one stream.
class ServerEnd {
 public:
  explicit ServerEnd(const v1::StreamConfig& config)
      : session_(&Models(), {.stream_id = "1"}) {
    v1::ClassifyContactRequest request;
    *request.mutable_config() = config;
    const absl::Status status = session_.OnRequest(request);
    EXPECT_TRUE(status.ok()) << status;
    started_ = Next()->started();
    session_.responses().FinishWrite();
  }
  void Send(const v1::ClassifyContactRequest& request) {
    const absl::Status status = session_.OnRequest(request);
    ASSERT_TRUE(status.ok()) << status;
  }
  // The next response, to be finished by Taken; null if none waits.
  const v1::ClassifyContactResponse* Next() {
    return session_.responses().StartWrite(0);
  }
  void Taken() { session_.responses().FinishWrite(); }
  StreamSession& session() { return session_; }
  const v1::StreamStarted& started() const { return started_; }

 private:
  StreamSession session_;
  v1::StreamStarted started_;
};

std::string Bits(v1::Answer answer) {
  answer.mutable_diagnostics()->clear_server_compute_ns();
  answer.mutable_diagnostics()->clear_queue_ns();
  return answer.SerializeAsString();
}

std::vector<v1::Answer> Uninterrupted(
    const v1::StreamConfig& config,
    const std::vector<v1::ClassifyContactRequest>& script) {
  ServerEnd server(config);
  std::vector<v1::Answer> answers;
  for (const v1::ClassifyContactRequest& request : script) {
    server.Send(request);
    while (const auto* response = server.Next()) {
      answers.push_back(response->answer());
      server.Taken();
    }
  }
  return answers;
}

// A robot whose stream is lost again and again.
class LossyRobot {
 public:
  LossyRobot(const v1::StreamConfig& config, uint64_t seed, int losses_in,
             size_t replay_bytes = limits::kMaxReplayBytes)
      : config_(config),
        random_(seed),
        losses_in_(losses_in),
        server_(std::make_unique<ServerEnd>(config)),
        history_(config, server_->started(), replay_bytes) {}

  void Run(const std::vector<v1::ClassifyContactRequest>& script) {
    for (const v1::ClassifyContactRequest& request : script) {
      if (Loses()) Resume();
      if (request.has_frames()) {
        ASSERT_TRUE(history_.Add(request.frames()));
        // The loss is noticed later: the frames wait.
        if (Loses()) {
          Resume();
        } else {
          history_.SentAll();
          server_->Send(request);
        }
      } else {
        history_.EndTrial();
        if (random_.Index(3) == 0) {
          Resume();
        } else {
          server_->Send(request);
        }
      }
      while (!Receive(Loses()) || history_.ending()) Resume();
      most_bytes_ = std::max(most_bytes_, history_.bytes());
    }
  }

  const std::vector<v1::Answer>& answers() const { return answers_; }
  StreamHistory& history() { return history_; }
  int losses() const { return losses_; }
  int inexact() const { return inexact_; }
  size_t most_bytes() const { return most_bytes_; }

 private:
  bool Loses() { return random_.Index(losses_in_) == 0; }
  // Rarer while frames are sent again: else few streams would get that far.
  bool LosesAgain() { return random_.Index(20L * losses_in_) == 0; }

  // Takes what the server has sent. False if the stream is lost.
  bool Receive(bool lost) {
    const size_t taken = lost ? random_.Index(3) : SIZE_MAX;
    for (size_t i = 0; i < taken; ++i) {
      const auto* response = server_->Next();
      if (response == nullptr) break;
      const auto* shown = history_.Take(*response);
      if (shown != nullptr) answers_.push_back(shown->answer());
      server_->Taken();
    }
    if (!lost) return true;
    // A server that drains ends the trial too soon.
    if (random_.Index(2) == 0) Drain();
    return false;
  }

  void Drain() {
    server_->session().Finish(absl::UnavailableError(""));
    while (const auto* response = server_->Next()) {
      const auto* shown = history_.Take(*response);
      if (shown != nullptr) answers_.push_back(shown->answer());
      server_->Taken();
    }
  }

  void Resume() {
    v1::ClassifyContactRequest request;
    do {
      ++losses_;
      server_ = std::make_unique<ServerEnd>(config_);
      inexact_ += history_.BeginStream() == StreamHistory::Beginning::kLost;
    } while (!SendAll(&request));
  }

  bool SendAll(v1::ClassifyContactRequest* request) {
    while (history_.NextUnsent(request->mutable_frames())) {
      server_->Send(*request);
      if (LosesAgain()) return false;
      if (!Receive(LosesAgain())) return false;
    }
    if (history_.ending()) {
      server_->Send(testing::EndOfTrialRequest());
      return Receive(Loses());
    }
    return true;
  }

  const v1::StreamConfig config_;
  Random random_;
  const int losses_in_;
  std::unique_ptr<ServerEnd> server_;
  StreamHistory history_;
  std::vector<v1::Answer> answers_;
  int losses_ = 0;
  int inexact_ = 0;
  size_t most_bytes_ = 0;
};

void ExpectEqual(const std::vector<v1::Answer>& got,
                 const std::vector<v1::Answer>& want) {
  ASSERT_EQ(got.size(), want.size());
  for (size_t i = 0; i < want.size(); ++i) {
    ASSERT_EQ(Bits(got[i]), Bits(want[i]))
        << "answer " << i << "\n got " << got[i].ShortDebugString() << "\nwant "
        << want[i].ShortDebugString();
  }
}

struct Case {
  v1::ResultCadence cadence;
  uint32_t interval;
  bool with_poses;
  bool light_touch;
  double rate_hz;
  uint32_t batch;
  int columns = 6;
};

TEST(StreamHistoryTest, LostStreamsGoOnBitForBit) {
  const Case cases[] = {
      {v1::RESULT_CADENCE_EVERY_FRAME, 0, true, false, 100, 1},
      {v1::RESULT_CADENCE_EVERY_FRAME, 0, false, false, 100, 3},
      {v1::RESULT_CADENCE_EVERY_FRAME, 0, true, false, 1000, 2},
      {v1::RESULT_CADENCE_EVERY_FRAME, 0, true, true, 100, 1},
      {v1::RESULT_CADENCE_EVERY_N_FRAMES, 7, true, false, 100, 2},
      {v1::RESULT_CADENCE_ON_CHANGE, 0, true, false, 100, 1},
      {v1::RESULT_CADENCE_EVENTS, 0, true, false, 100, 4},
      {v1::RESULT_CADENCE_EVERY_FRAME, 0, true, false, 100, 1, 14},
      {v1::RESULT_CADENCE_EVENTS, 0, false, false, 100, 3, 14},
      {v1::RESULT_CADENCE_EVERY_FRAME, 0, false, true, 100, 1, 14},
      {v1::RESULT_CADENCE_EVERY_FRAME, 0, true, false, 100, 2, 30},
      {v1::RESULT_CADENCE_EVENTS, 0, false, true, 100, 3, 30},
  };
  int losses = 0;
  // Answers with two contacts and with three, and contacts that joined another.
  int with_two = 0;
  int with_three = 0;
  int merged = 0;
  for (const Case& c : cases) {
    v1::StreamConfig config =
        SmallConfig(c.with_poses, c.light_touch, c.rate_hz, c.columns);
    config.set_cadence(c.cadence);
    config.set_result_interval_frames(c.interval);
    for (uint64_t seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE(absl::StrCat("cadence ", c.cadence, " poses ", c.with_poses,
                                " light touch ", c.light_touch, " columns ",
                                c.columns, " seed ", seed));
      const int frames = c.rate_hz == 1000 ? 1000 : 400;
      const auto script = Script(config, 3, frames, c.batch, seed);
      LossyRobot robot(config, seed, 60);
      robot.Run(script);
      const std::vector<v1::Answer> want = Uninterrupted(config, script);
      ExpectEqual(robot.answers(), want);
      for (const v1::Answer& answer : want) {
        with_two += answer.contacts_size() > 1;
        with_three += answer.contacts_size() > 2;
        for (const v1::ContactEvent& event : answer.events()) {
          merged += event.kind() == v1::ContactEvent::KIND_MERGED;
        }
      }
      EXPECT_EQ(robot.inexact(), 0);
      losses += robot.losses();
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(losses, 1000);
  EXPECT_GT(with_two, 500);
  EXPECT_GT(with_three, 200);
  EXPECT_GT(merged, 20);
}

// Plays `frames` frames without a touch, or with one touch that never ends.
void PlayOn(int frames, const testing::Counts& taxels, ServerEnd& server,
            StreamHistory& history) {
  v1::ClassifyContactRequest request;
  v1::FrameBatch* batch = request.mutable_frames();
  batch->set_frame_count(1);
  batch->mutable_taxels()->assign(reinterpret_cast<const char*>(taxels.data()),
                                  taxels.size() * sizeof(taxels[0]));
  testing::AddPose(Pose(), batch);
  uint64_t sequence = history.last_sequence();
  for (int t = 0; t < frames; ++t) {
    batch->set_first_sequence(++sequence);
    batch->set_first_capture_time_ns(static_cast<int64_t>(sequence) *
                                     10'000'000);
    ASSERT_TRUE(history.Add(*batch));
    history.SentAll();
    server.Send(request);
    while (const auto* response = server.Next()) {
      EXPECT_EQ(history.Take(*response), response);
      server.Taken();
    }
  }
}

TEST(StreamHistoryTest, KeepsLittleWhileNothingTouches) {
  const v1::StreamConfig config = SmallConfig(true, false);
  ServerEnd server(config);
  StreamHistory history(config, server.started(), limits::kMaxReplayBytes);
  PlayOn(10'000, Counts(24, 0), server, history);
  // 0.2 s, a message of 24 taxels and a pose taking some 200 bytes.
  EXPECT_LT(history.bytes(), 24u * 250);
  EXPECT_EQ(history.BeginStream(), StreamHistory::Beginning::kKnown);
}

TEST(StreamHistoryTest, AllocatesNothingOnceItIsFull) {
  const v1::StreamConfig config = SmallConfig(true, false);
  ServerEnd server(config);
  StreamHistory history(config, server.started(), limits::kMinReplayBytes);
  PlayOn(4'000, Counts(24, 9'000), server, history);
  EXPECT_EQ(history.capacity(), limits::kMinReplayBytes);
  const auto allocations = [&](int frames) {
    const testing::AllocationCounter counter;
    PlayOn(frames, Counts(24, 9'000), server, history);
    return counter.count();
  };
  // Making the test's request and its end allocate the same in both.
  EXPECT_EQ(allocations(10), allocations(1'000));
  EXPECT_EQ(history.BeginStream(), StreamHistory::Beginning::kLost);
}

}  // namespace
}  // namespace tactus::internal::client
