// ResumableStream against the program tactusd, which is killed and comes back.
#include "client/stream/resumable_stream.h"

#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/drivers/sim_driver.h"
#include "client/stream/frame_encoder.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "gtest/gtest.h"
#include "tests/client/stream/restarted_server.h"
#include "tests/server/support/requests.h"

namespace tactus::internal::client {
namespace {

using std::chrono::milliseconds;
using testing::RestartedServer;

// Requests with one frame each, and the ends of trials.
struct Recording {
  v1::StreamConfig config;
  std::vector<v1::ClassifyContactRequest> requests;
};

// Trials with several contacts each, for the built-in model without poses. The
// pauses are longer than the 0.5 s that release a contact.
const Recording& Touches() {
  static const auto* const recording = [] {
    auto* made = new Recording;
    made->config = testing::ConfigRequest(testing::kModelWithoutPoses).config();
    made->config.clear_never_release();
    made->config.set_with_diagnostics(true);
    uint64_t sequence = 0;
    for (int trial = 0; trial < 2; ++trial) {
      for (int contact = 0; contact < 2; ++contact) {
        auto frames = testing::Contact(60, 10 * trial + contact);
        frames.resize(130, testing::Untouched());
        for (const testing::Counts& frame : frames) {
          made->requests.push_back(testing::DenseU16(++sequence, {frame}));
        }
      }
      made->requests.push_back(testing::EndOfTrialRequest());
    }
    return made;
  }();
  return *recording;
}

// Simulated contacts with poses, on a skin with light touch, for the default
// model.
const Recording& SimulatedContacts() {
  static const auto* const recording = [] {
    auto* made = new Recording;
    SimDriver driver({.seed = 5}, /*trials=*/2, {});
    const SkinInfo info = *driver.Configure();
    EXPECT_TRUE(driver.Activate().ok());
    made->config = MakeConfig(info);
    FrameEncoder encoder(info, {});
    SkinFrame frame;
    for (;;) {
      const ReadResult result = *driver.Read(frame);
      if (result == ReadResult::kEndOfData) break;
      if (result == ReadResult::kEndOfTrial) {
        made->requests.push_back(testing::EndOfTrialRequest());
        continue;
      }
      encoder.Add(frame);
      made->requests.push_back(encoder.request());
      encoder.Clear();
    }
    return made;
  }();
  return *recording;
}

std::string SameBits(v1::Answer answer) {
  answer.mutable_diagnostics()->clear_server_compute_ns();
  answer.mutable_diagnostics()->clear_queue_ns();
  answer.clear_superseded();
  return answer.SerializeAsString();
}

// A robot that waits for the answer to each frame. An impatient one does not
// wait while its stream is lost.
class Robot {
 public:
  // What happens before request `index` is sent.
  using Before = std::function<void(size_t index)>;

  Robot(const std::string& address, const Recording& recording,
        const ResumeOptions& options = {})
      : recording_(recording),
        stream_(*ResumableStream::Open(
            MakeChannel(address), recording.config,
            [this](const auto& r) { OnResponse(r); }, options)) {}

  absl::Status Play(const Before& before = {}) {
    for (size_t i = 0; i < recording_.requests.size(); ++i) {
      const v1::ClassifyContactRequest& request = recording_.requests[i];
      if (before) before(i);
      if (request.has_frames()) {
        TACTUS_RETURN_IF_ERROR(stream_->Send(request));
        Await(request.frames().first_sequence());
      } else {
        TACTUS_ASSIGN_OR_RETURN(const v1::Answer final_answer,
                                stream_->EndTrial());
        EXPECT_TRUE(final_answer.is_final());
      }
    }
    return stream_->Close();
  }

  // Interim posteriors by sequence number, and finals.
  const std::map<uint64_t, v1::Answer>& interims() const { return interims_; }
  const std::vector<v1::Answer>& finals() const { return finals_; }
  ResumableStream& stream() { return *stream_; }
  void set_patient(bool patient) { patient_ = patient; }

 private:
  void OnResponse(const v1::ClassifyContactResponse& response) {
    if (!response.has_answer()) return;
    const v1::Answer& posterior = response.answer();
    const std::lock_guard lock(mutex_);
    if (posterior.is_final()) {
      finals_.push_back(posterior);
    } else {
      EXPECT_GT(posterior.sequence(), last_) << "delivered twice";
      last_ = posterior.sequence();
      interims_[last_] = posterior;
    }
    answered_.notify_all();
  }

  void Await(uint64_t sequence) {
    std::unique_lock lock(mutex_);
    while (last_ < sequence && !stream_->ended() &&
           (patient_ || !stream_->resuming())) {
      answered_.wait_for(lock, milliseconds(5));
    }
  }

  const Recording& recording_;
  bool patient_ = true;
  std::mutex mutex_;
  std::condition_variable answered_;
  uint64_t last_ = 0;
  std::map<uint64_t, v1::Answer> interims_;
  std::vector<v1::Answer> finals_;
  std::unique_ptr<ResumableStream> stream_;
};

// What the robot gets without a loss.
const Robot& Undisturbed(const Recording& recording) {
  static auto* const robots =
      new std::map<const Recording*, std::unique_ptr<Robot>>;
  std::unique_ptr<Robot>& robot = (*robots)[&recording];
  if (robot != nullptr) return *robot;
  testing::ChildTactusd server;
  robot = std::make_unique<Robot>(server.address(), recording);
  const absl::Status status = robot->Play();
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_EQ(robot->stream().statistics().resumed, 0u);
  return *robot;
}

void ExpectUndisturbed(const Robot& robot, const Recording& recording) {
  const Robot& want = Undisturbed(recording);
  ASSERT_EQ(robot.finals().size(), want.finals().size());
  for (size_t i = 0; i < want.finals().size(); ++i) {
    EXPECT_EQ(SameBits(robot.finals()[i]), SameBits(want.finals()[i]))
        << " got " << robot.finals()[i].ShortDebugString() << "\nwant "
        << want.finals()[i].ShortDebugString();
  }
  for (const auto& [sequence, posterior] : robot.interims()) {
    ASSERT_EQ(SameBits(posterior), SameBits(want.interims().at(sequence)))
        << " got " << posterior.ShortDebugString() << "\nwant "
        << want.interims().at(sequence).ShortDebugString();
  }
  // None is missing without being counted.
  EXPECT_EQ(robot.interims().size() + robot.finals().back().superseded(),
            want.interims().size());
}

using Events = std::map<size_t, std::function<void(RestartedServer&, Robot&)>>;

// Plays a recording; each event happens before its request. Returns how often
// the stream was resumed.
uint64_t ExpectResumed(const Events& events,
                       const Recording& recording = Touches(),
                       bool patient = true) {
  RestartedServer server({"--drain-grace-ms=200"});
  Robot robot(server.address(), recording);
  robot.set_patient(patient);
  const absl::Status status = robot.Play([&](size_t index) {
    const auto event = events.find(index);
    if (event != events.end()) event->second(server, robot);
  });
  EXPECT_TRUE(status.ok()) << status;
  if (!status.ok()) return 0;
  ExpectUndisturbed(robot, recording);
  EXPECT_EQ(robot.stream().statistics().without_beginning, 0u);
  return robot.stream().statistics().resumed;
}

void Restart(RestartedServer& server, Robot&) { server.Restart(); }

TEST(ResumableStreamTest, AServerIsKilledInMidContact) {
  const v1::Answer answer = Undisturbed(Touches()).interims().at(30);
  ASSERT_EQ(answer.contacts_size(), 1);
  ASSERT_EQ(answer.contacts(0).state(), v1::Contact::STATE_TOUCHING);
  EXPECT_EQ(ExpectResumed({{30, Restart}}), 1u);
}

TEST(ResumableStreamTest, TwiceInOneContact) {
  EXPECT_EQ(ExpectResumed({{30, Restart}, {31, Restart}}), 2u);
}

TEST(ResumableStreamTest, BeforeTheFirstAnswer) {
  EXPECT_EQ(ExpectResumed({{0, Restart}}), 1u);
}

TEST(ResumableStreamTest, BetweenContactsOfATrial) {
  ASSERT_EQ(Undisturbed(Touches()).interims().at(120).contacts_size(), 0);
  // In the pause after each contact.
  EXPECT_EQ(ExpectResumed({{120, Restart}, {258, Restart}}), 2u);
}

TEST(ResumableStreamTest, BetweenTrials) {
  // Before and after the end of a trial.
  EXPECT_EQ(ExpectResumed({{260, Restart}, {261, Restart}}), 2u);
}

TEST(ResumableStreamTest, FramesWaitWhileThereIsNoServer) {
  const auto kill = [](RestartedServer& server, Robot& robot) {
    server.Kill();
    robot.set_patient(false);
  };
  const auto start = [](RestartedServer& server, Robot& robot) {
    server.Start();
    robot.set_patient(true);
  };
  EXPECT_EQ(ExpectResumed({{30, kill}, {50, start}}), 1u);
}

TEST(ResumableStreamTest, AServerDrainsInMidContact) {
  const auto drain = [](RestartedServer& server, Robot&) {
    server.Drain();
    server.Start();
  };
  EXPECT_EQ(ExpectResumed({{30, drain}}), 1u);
}

// Kills at random frames; the places are printed.
TEST(ResumableStreamTest, KilledAnywhere) {
  for (const Recording* recording : {&Touches(), &SimulatedContacts()}) {
    for (uint64_t seed = 1; seed <= 4; ++seed) {
      Random random(seed);
      Events events;
      std::string places;
      for (int kill = 0; kill < 3; ++kill) {
        const size_t place = random.Index(recording->requests.size());
        events[place] = Restart;
        absl::StrAppend(&places, " ", place);
      }
      SCOPED_TRACE(absl::StrCat("kills before requests", places));
      std::printf("kills before requests%s\n", places.c_str());
      const bool patient = seed % 2 == 0;
      const uint64_t resumed = ExpectResumed(events, *recording, patient);
      // A stream may be lost again before it was resumed.
      EXPECT_GE(resumed, patient ? events.size() : 1);
      EXPECT_LE(resumed, events.size());
      if (HasFatalFailure()) return;
    }
  }
}

}  // namespace
}  // namespace tactus::internal::client
