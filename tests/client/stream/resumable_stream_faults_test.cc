// ResumableStream and what it does not resume, or not at once: servers that do
// not come back, refuse the stream, end it early or never answer.
#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "client/stream/resumable_stream.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_proto.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/stream/restarted_server.h"
#include "tests/server/support/requests.h"
#include "tests/support/scripted_server.h"
#include "tests/support/time_limit.h"

namespace tactus::internal::client {
namespace {

using std::chrono::milliseconds;
using testing::DenseU16;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::RestartedServer;
using testing::ScriptedServer;
using testing::TimeLimit;
using testing::Touch;

v1::StreamConfig NoPoses() {
  return testing::ConfigRequest(testing::kModelWithoutPoses).config();
}

// What the robot has got.
class Answers {
 public:
  ContactStream::OnResponse Callback() {
    return [this](const auto& response) {
      const std::lock_guard lock(mutex_);
      posteriors_.push_back(response.answer());
    };
  }
  std::vector<v1::Answer> posteriors() {
    const std::lock_guard lock(mutex_);
    return posteriors_;
  }
  std::vector<uint64_t> sequences() {
    std::vector<uint64_t> sequences;
    for (const v1::Answer& posterior : posteriors()) {
      sequences.push_back(posterior.sequence());
    }
    return sequences;
  }
  // Waits until there are `count` answers.
  bool Await(size_t count) {
    for (int i = 0; i < 10'000; ++i) {
      if (posteriors().size() >= count) return true;
      std::this_thread::sleep_for(milliseconds(1));
    }
    return false;
  }

 private:
  std::mutex mutex_;
  std::vector<v1::Answer> posteriors_;
};

// A script whose calls differ: `calls[i]` serves the i-th, and the last one all
// later ones. It has read the config and counts the calls.
class ScriptedCalls {
 public:
  using Call = std::function<grpc::Status(ScriptedServer::Stream*)>;

  explicit ScriptedCalls(std::vector<Call> calls)
      : calls_(std::move(calls)),
        server_([this](grpc::ServerContext*, ScriptedServer::Stream* stream) {
          const size_t call = std::min<size_t>(count_++, calls_.size() - 1);
          v1::ClassifyContactRequest config;
          stream->Read(&config);
          {
            const std::lock_guard lock(mutex_);
            models_.push_back(config.config().model());
          }
          return calls_[call](stream);
        }) {}

  std::string address() const { return server_.address(); }
  size_t count() const { return count_; }
  // What the calls asked for.
  std::vector<std::string> models() {
    const std::lock_guard lock(mutex_);
    return models_;
  }

 private:
  const std::vector<Call> calls_;
  std::mutex mutex_;
  std::vector<std::string> models_;
  std::atomic<size_t> count_ = 0;
  ScriptedServer server_;
};

// Answers `frames` messages, then ends the stream with OK; with finals if they
// are wanted.
ScriptedCalls::Call Answering(int frames, bool with_finals = true) {
  return [=](ScriptedServer::Stream* stream) {
    auto started = testing::GoodStarted();
    started.mutable_started()->set_model_version("models/m/versions/7");
    stream->Write(started);
    v1::ClassifyContactRequest request;
    uint64_t sequence = 0;
    for (int i = 0; i < frames && stream->Read(&request); ++i) {
      if (request.has_frames()) {
        sequence = request.frames().first_sequence();
        stream->Write(testing::GoodAnswer(sequence));
      } else if (with_finals) {
        auto response = testing::GoodAnswer(sequence);
        response.mutable_answer()->set_is_final(true);
        stream->Write(response);
      }
    }
    return grpc::Status::OK;
  };
}

ScriptedCalls::Call Refusing(const absl::Status& status) {
  return [status](ScriptedServer::Stream*) {
    return grpc::Status(static_cast<grpc::StatusCode>(status.code()),
                        std::string(status.message()),
                        ToStatusProto(status).SerializeAsString());
  };
}

TEST(ResumableStreamFaultsTest, AStreamThatTheServerEndsEarlyIsResumed) {
  ScriptedCalls server({Answering(2), Answering(1'000)});
  Answers answers;
  auto stream = *ResumableStream::Open(MakeChannel(server.address()), NoPoses(),
                                       answers.Callback());
  for (uint64_t sequence = 1; sequence <= 5; ++sequence) {
    ASSERT_TRUE(stream->Send(DenseU16(sequence, {Touch(1)})).ok());
    ASSERT_TRUE(answers.Await(sequence));
  }
  EXPECT_TRUE(stream->EndTrial().ok());
  EXPECT_TRUE(stream->Close().ok());
  EXPECT_EQ(answers.sequences(), (std::vector<uint64_t>{1, 2, 3, 4, 5, 5}));
  // The second stream asks for the version that the first one got.
  EXPECT_THAT(server.models(),
              ElementsAre(testing::kModelWithoutPoses, "models/m/versions/7"));
  EXPECT_EQ(stream->statistics().resumed, 1u);
  EXPECT_EQ(ReasonOf(stream->Send(DenseU16(6, {Touch(1)}))), "STREAM_FINISHED");
}

TEST(ResumableStreamFaultsTest, KilledWhileTheFirstFrameIsOnItsWay) {
  RestartedServer server;
  for (int i = 0; i < 5; ++i) {
    Answers answers;
    auto stream = *ResumableStream::Open(MakeChannel(server.address()),
                                         NoPoses(), answers.Callback());
    ASSERT_TRUE(stream->Send(DenseU16(1, {Touch(1)})).ok());
    server.Restart();
    ASSERT_TRUE(answers.Await(1));
    const auto answer = stream->EndTrial();
    ASSERT_TRUE(answer.ok()) << answer.status();
    EXPECT_EQ(answer->contacts(0).id(), 1u);
    EXPECT_TRUE(stream->Close().ok());
    EXPECT_EQ(answers.sequences(), (std::vector<uint64_t>{1, 1}));
    EXPECT_EQ(stream->statistics().resumed, 1u);
  }
}

// Notices are for the robot too: it may finish what it does elsewhere.
TEST(ResumableStreamFaultsTest, TheRobotLearnsOfADrain) {
  RestartedServer server({"--drain-grace-ms=300"});
  std::atomic<int> drains = 0;
  auto stream = *ResumableStream::Open(
      MakeChannel(server.address()), NoPoses(), [&](const auto& response) {
        drains += response.notice().kind() == v1::StreamNotice::KIND_DRAINING;
      });
  ASSERT_TRUE(stream->Send(DenseU16(1, {Touch(1)})).ok());
  server.Drain();
  server.Start();
  EXPECT_TRUE(stream->EndTrial().ok());
  EXPECT_EQ(drains, 1);
  EXPECT_EQ(stream->statistics().resumed, 1u);
}

TEST(ResumableStreamFaultsTest, AServerThatDoesNotComeBackIsAnError) {
  RestartedServer server;
  Answers answers;
  auto stream = *ResumableStream::Open(MakeChannel(server.address()), NoPoses(),
                                       answers.Callback(),
                                       {.resume_for = milliseconds(400)});
  ASSERT_TRUE(stream->Send(DenseU16(1, {Touch(1)})).ok());
  ASSERT_TRUE(answers.Await(1));
  server.Kill();
  // The frames are kept until the limit.
  absl::Status status = stream->Send(DenseU16(2, {Touch(1)}));
  EXPECT_TRUE(status.ok()) << status;
  TimeLimit limit("EndTrial waits for ever", [&] { stream->Cancel(); });
  status = stream->EndTrial().status();
  EXPECT_EQ(ReasonOf(status), "NO_RESPONSE") << status;
  EXPECT_EQ(status.code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("could not be resumed within 400 ms"));
  EXPECT_THAT(std::string(status.message()), HasSubstr("start the server"));
  EXPECT_TRUE(stream->ended());
  EXPECT_EQ(stream->Send(DenseU16(3, {Touch(1)})), status);
  EXPECT_EQ(stream->Close(), status);
}

TEST(ResumableStreamFaultsTest, ALimitOf0ResumesNothing) {
  RestartedServer server;
  Answers answers;
  auto stream = *ResumableStream::Open(MakeChannel(server.address()), NoPoses(),
                                       answers.Callback(),
                                       {.resume_for = milliseconds(0)});
  server.Restart();
  EXPECT_EQ(stream->EndTrial().status().code(), absl::StatusCode::kUnavailable);
}

TEST(ResumableStreamFaultsTest, RefusalsAreNotRepeated) {
  for (const absl::Status& refusal :
       {ModelNotFound("models/default/versions/1"), Unauthenticated("no token"),
        PermissionDenied("ClassifyContact", "robot", "trainer"),
        InvalidConfig("scale", -1, "above 0"), GeometryMismatch("a", "b"),
        MessageTooLarge(2, 1), absl::ResourceExhaustedError("from gRPC"),
        absl::FailedPreconditionError("")}) {
    ScriptedCalls server({Answering(1), Refusing(refusal)});
    Answers answers;
    auto stream = *ResumableStream::Open(MakeChannel(server.address()),
                                         NoPoses(), answers.Callback());
    ASSERT_TRUE(stream->Send(DenseU16(1, {Touch(1)})).ok());
    const absl::Status status = stream->EndTrial().status();
    EXPECT_EQ(status.code(), refusal.code()) << status;
    EXPECT_EQ(ReasonOf(status), ReasonOf(refusal));
    EXPECT_THAT(std::string(status.message()),
                HasSubstr("the stream cannot be resumed"));
    EXPECT_EQ(server.count(), 2u) << refusal;
  }
}

TEST(ResumableStreamFaultsTest, FullServersAreAskedAgain) {
  const auto full = Refusing(StreamLimit("streams", 10));
  ScriptedCalls server({Answering(1), full, full, Answering(1'000)});
  Answers answers;
  auto stream = *ResumableStream::Open(MakeChannel(server.address()), NoPoses(),
                                       answers.Callback());
  ASSERT_TRUE(stream->Send(DenseU16(1, {Touch(1)})).ok());
  EXPECT_TRUE(stream->EndTrial().ok());
  EXPECT_EQ(server.count(), 4u);
  // A full server at the beginning is an error.
  ScriptedCalls full_server({full});
  EXPECT_EQ(ReasonOf(ResumableStream::Open(MakeChannel(full_server.address()),
                                           NoPoses(), answers.Callback())
                         .status()),
            "STREAM_LIMIT");
}

TEST(ResumableStreamFaultsTest, AnotherBundleOfThatNameIsAnError) {
  ScriptedCalls server({Answering(1), [](ScriptedServer::Stream* stream) {
                          auto started = testing::GoodStarted();
                          started.mutable_started()->set_bundle_sha256("new");
                          stream->Write(started);
                          v1::ClassifyContactRequest request;
                          while (stream->Read(&request)) {
                          }
                          return grpc::Status::OK;
                        }});
  Answers answers;
  auto stream = *ResumableStream::Open(MakeChannel(server.address()), NoPoses(),
                                       answers.Callback());
  ASSERT_TRUE(stream->Send(DenseU16(1, {Touch(1)})).ok());
  const absl::Status status = stream->EndTrial().status();
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition) << status;
  EXPECT_EQ(ReasonOf(status), "MODEL_NOT_FOUND");
}

TEST(ResumableStreamFaultsTest, AFinalThatDoesNotComeIsAskedForAgain) {
  ScriptedCalls server(
      {Answering(1'000, /*with_finals=*/false), Answering(1'000)});
  Answers answers;
  ResumeOptions options;
  options.timeouts.final_answer = milliseconds(200);
  auto stream = *ResumableStream::Open(MakeChannel(server.address()), NoPoses(),
                                       answers.Callback(), options);
  ASSERT_TRUE(stream->Send(DenseU16(1, {Touch(1)})).ok());
  EXPECT_TRUE(stream->EndTrial().ok());
  EXPECT_EQ(server.count(), 2u);
}

// A frame that ends every server must not be sent for ever.
TEST(ResumableStreamFaultsTest, AFrameThatNoServerSurvivesIsGivenUp) {
  const auto failing = [](ScriptedServer::Stream* stream) {
    stream->Write(testing::GoodStarted());
    v1::ClassifyContactRequest request;
    stream->Read(&request);
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone");
  };
  ScriptedCalls server({failing});
  Answers answers;
  auto stream = *ResumableStream::Open(MakeChannel(server.address()), NoPoses(),
                                       answers.Callback(),
                                       {.resume_for = milliseconds(500)});
  ASSERT_TRUE(stream->Send(DenseU16(1, {Touch(1)})).ok());
  TimeLimit limit("Close waits for ever", [&] { stream->Cancel(); });
  const absl::Status status = stream->Close();
  EXPECT_EQ(ReasonOf(status), "NO_RESPONSE") << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("gone"));
  // How often it was sent depends on the machine's speed.
  EXPECT_GE(server.count(), 2u);
}

TEST(ResumableStreamFaultsTest, BadRequestsAreRefusedAtOnce) {
  RestartedServer server;
  Answers answers;
  EXPECT_EQ(ReasonOf(ResumableStream::Open(MakeChannel(server.address()),
                                           NoPoses(), answers.Callback(),
                                           {.replay_bytes = 1'000})
                         .status()),
            "INVALID_CONFIG");
  auto stream = *ResumableStream::Open(MakeChannel(server.address()), NoPoses(),
                                       answers.Callback());
  ASSERT_TRUE(stream->Send(DenseU16(5, {Touch(1)})).ok());
  EXPECT_EQ(ReasonOf(stream->Send(DenseU16(5, {Touch(1)}))),
            "SEQUENCE_REGRESSION");
  EXPECT_EQ(ReasonOf(stream->Send(testing::EndOfTrialRequest())),
            "INVALID_CONFIG");
  EXPECT_EQ(ReasonOf(stream->Send(DenseU16(6, {}))),
            "FRAME_COUNT_OUT_OF_RANGE");
  // The stream goes on.
  ASSERT_TRUE(stream->Send(DenseU16(6, {Touch(1)})).ok());
  EXPECT_TRUE(stream->EndTrial().ok());
  // The server's verdict on bad frames ends it.
  ASSERT_TRUE(stream->Send(DenseU16(7, {{1, 2, 3}})).ok());
  EXPECT_EQ(ReasonOf(stream->EndTrial().status()), "FRAME_SIZE_MISMATCH");
  EXPECT_EQ(stream->statistics().resumed, 0u);
}

TEST(ResumableStreamFaultsTest, AnIdleStreamIsResumedByTheNextFrame) {
  RestartedServer server({"--idle-timeout-ms=150"});
  Answers answers;
  auto stream = *ResumableStream::Open(MakeChannel(server.address()), NoPoses(),
                                       answers.Callback());
  ASSERT_TRUE(stream->Send(DenseU16(1, {Touch(1)})).ok());
  while (!stream->resuming()) std::this_thread::sleep_for(milliseconds(5));
  std::this_thread::sleep_for(milliseconds(500));
  EXPECT_EQ(stream->statistics().resumed, 0u);
  ASSERT_TRUE(stream->Send(DenseU16(2, {Touch(1)})).ok());
  const auto answer = stream->EndTrial();
  ASSERT_TRUE(answer.ok()) << answer.status();
  EXPECT_EQ(answer->contacts(0).onset_sequence(), 1u);
  EXPECT_GE(stream->statistics().resumed, 1u);
  EXPECT_TRUE(stream->Close().ok());
}

TEST(ResumableStreamFaultsTest, CancelEndsAnAttempt) {
  RestartedServer server;
  Answers answers;
  auto stream = *ResumableStream::Open(MakeChannel(server.address()), NoPoses(),
                                       answers.Callback(),
                                       {.resume_for = std::chrono::hours(1)});
  server.Kill();
  while (!stream->resuming()) std::this_thread::sleep_for(milliseconds(5));
  TimeLimit limit("EndTrial waits for ever", [&] { server.Start(); });
  std::thread canceller([&] { stream->Cancel(); });
  EXPECT_EQ(stream->EndTrial().status().code(), absl::StatusCode::kCancelled);
  canceller.join();
  // Destruction does the same.
  server.Start();
  stream = *ResumableStream::Open(MakeChannel(server.address()), NoPoses(),
                                  answers.Callback(),
                                  {.resume_for = std::chrono::hours(1)});
  server.Kill();
  stream.reset();
}

// A contact that is longer than what is kept.
TEST(ResumableStreamFaultsTest, ALostBeginningIsReported) {
  RestartedServer server;
  Answers answers;
  auto stream = *ResumableStream::Open(
      MakeChannel(server.address()), NoPoses(), answers.Callback(),
      {.replay_bytes = limits::kMinReplayBytes});
  constexpr uint64_t kFrames = 500;
  uint64_t sequence = 0;
  while (sequence < kFrames) {
    ASSERT_TRUE(stream->Send(DenseU16(++sequence, {Touch(1)})).ok());
    ASSERT_TRUE(answers.Await(sequence));
  }
  EXPECT_EQ(answers.posteriors().back().contacts(0).id(), 1u);
  server.Restart();
  ASSERT_TRUE(stream->Send(DenseU16(++sequence, {Touch(1)})).ok());
  ASSERT_TRUE(answers.Await(sequence));
  const v1::Answer next = answers.posteriors().back();
  EXPECT_EQ(next.sequence(), kFrames + 1);
  ASSERT_EQ(next.contacts_size(), 1);
  EXPECT_EQ(next.contacts(0).state(), v1::Contact::STATE_TOUCHING);
  EXPECT_EQ(next.contacts(0).id(), 2u);
  EXPECT_GT(next.contacts(0).onset_sequence(), 1u);
  EXPECT_EQ(stream->statistics().without_beginning, 1u);
  EXPECT_TRUE(stream->Close().ok());
  EXPECT_EQ(answers.posteriors().size(), kFrames + 2);
}

// There is no room for more frames that no server has got: Send waits.
TEST(ResumableStreamFaultsTest, SendWaitsForRoom) {
  RestartedServer server;
  Answers answers;
  auto stream = *ResumableStream::Open(
      MakeChannel(server.address()), NoPoses(), answers.Callback(),
      {.replay_bytes = limits::kMinReplayBytes});
  server.Kill();
  // Frames that the server may have got would make room.
  while (!stream->resuming()) std::this_thread::sleep_for(milliseconds(5));
  constexpr uint64_t kFrames = 500;
  std::atomic<uint64_t> sent = 0;
  std::thread robot([&] {
    while (sent < kFrames) {
      const absl::Status status =
          stream->Send(DenseU16(sent + 1, {testing::Untouched()}));
      ASSERT_TRUE(status.ok()) << status;
      ++sent;
    }
  });
  uint64_t before = 0;
  do {
    before = sent;
    std::this_thread::sleep_for(milliseconds(200));
  } while (before == 0 || sent != before);
  EXPECT_LT(sent, limits::kMinReplayBytes / (2 * testing::kCodyTaxels) + 1);
  server.Start();
  robot.join();
  const auto answer = stream->EndTrial();
  ASSERT_TRUE(answer.ok()) << answer.status();
  EXPECT_EQ(answer->sequence(), kFrames);
  EXPECT_EQ(answers.posteriors().size() - 1 + answer->superseded(), kFrames);
  EXPECT_EQ(stream->statistics().without_beginning, 0u);
}

}  // namespace
}  // namespace tactus::internal::client
