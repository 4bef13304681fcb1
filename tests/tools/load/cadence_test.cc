// Load tests in which the server leaves frames unanswered: what is lost, and
// what a delay is, against an in-process server and against servers that
// misbehave.
#include <atomic>
#include <vector>

#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"
#include "tests/support/scripted_server.h"
#include "tools/load/find_max.h"
#include "tools/load/load.h"

namespace tactus::internal::client {
namespace {

using testing::ScriptedServer;
using testing::TestServer;
using Stream = ScriptedServer::Stream;

constexpr int kRobots = 3;

const FrameScript& Script(uint32_t frames_per_message) {
  static const FrameScript one =
      *FrameScript::Create({.untouched_seconds = 0.1, .contacts = 1});
  static const FrameScript four = *FrameScript::Create(
      {.frames_per_message = 4, .untouched_seconds = 0.1, .contacts = 1});
  return frames_per_message == 1 ? one : four;
}

LoadOptions OptionsFor(const std::string& address, v1::ResultCadence cadence) {
  return {.servers = {address},
          .robots = kRobots,
          .rate_hz = 400,
          .seconds = 0.5,
          .warm_up_seconds = 0,
          .cadence = cadence};
}

LoadReport RunTest(const LoadOptions& options) {
  const auto report = RunLoad(options, Script(options.frames_per_message));
  EXPECT_TRUE(report.ok()) << report.status();
  return report.ok() ? *report : LoadReport();
}

class CadenceTest : public ::testing::Test {
 protected:
  CadenceTest() : server_({.listen = {"127.0.0.1:0"}}) {}

  LoadOptions Options(v1::ResultCadence cadence) {
    return OptionsFor(
        "127.0.0.1:" + std::to_string(server_.server().ports()[0]), cadence);
  }

  TestServer server_;
};

TEST_F(CadenceTest, EveryFrameIsAnsweredOrEveryMessageOnce) {
  for (const uint32_t frames : {1u, 4u}) {
    LoadOptions options = Options(v1::RESULT_CADENCE_EVERY_FRAME);
    options.frames_per_message = frames;
    const uint64_t messages = kRobots * 200 / frames;
    const LoadReport all = RunTest(options);
    EXPECT_EQ(all.sent, messages);
    // A slow machine may make the server drop answers.
    EXPECT_EQ(all.answers + all.superseded, messages * frames);
    EXPECT_LE(all.lost(), all.superseded);
    options.cadence = v1::RESULT_CADENCE_EVERY_N_FRAMES;
    const LoadReport once = RunTest(options);
    EXPECT_EQ(once.answered + once.superseded, messages);
    // Touches and decisions are reported in between.
    EXPECT_LE(once.answers, messages * frames);
    if (frames == 4) {
      EXPECT_LT(once.answers, all.answers + all.superseded);
    }
  }
}

TEST_F(CadenceTest, FramesWithoutAnAnswerAreNotLost) {
  for (const uint32_t frames : {1u, 4u}) {
    LoadOptions options = Options(v1::RESULT_CADENCE_EVENTS);
    options.frames_per_message = frames;
    const LoadReport events = RunTest(options);
    options.cadence = v1::RESULT_CADENCE_ON_CHANGE;
    const LoadReport changes = RunTest(options);
    for (const LoadReport& report : {events, changes}) {
      // Robots leave in the last tenth of the test.
      EXPECT_LE(report.sent, kRobots * 200 / frames);
      EXPECT_GE(report.sent, kRobots * 180 / frames);
      EXPECT_EQ(report.lost(), 0u);
      EXPECT_EQ(report.unannounced, 0u);
      EXPECT_EQ(report.failed, 0) << report.first_error;
      EXPECT_GT(report.answers, 0u);
      EXPECT_LT(report.answers, report.sent * frames / 2);
      EXPECT_GT(report.p50_ms, 0);
      EXPECT_GT(report.final_p50_ms, 0);
    }
    // Answers with events are sent on a change too.
    EXPECT_GE(changes.answers + changes.superseded, events.answers);
  }
}

TEST_F(CadenceTest, TheSearchWorksWithEachCadence) {
  for (const auto cadence :
       {v1::RESULT_CADENCE_EVERY_FRAME, v1::RESULT_CADENCE_ON_CHANGE,
        v1::RESULT_CADENCE_EVENTS}) {
    LoadOptions options = Options(cadence);
    options.seconds = 0.2;
    // Tests of a loaded machine may need more than one attempt.
    const auto most = FindMaxRobots(
        options,
        {.p99_limit_ms = 1e6, .min_robots = 2, .max_robots = 2, .attempts = 20},
        [](const LoadReport&) {});
    ASSERT_TRUE(most.ok()) << most.status();
    EXPECT_EQ(most->robots, 2) << cadence;
  }
}

// Reads until the half-close; returns how many frames came.
uint64_t ReadAll(Stream* stream) {
  v1::ClassifyContactRequest request;
  uint64_t frames = 0;
  while (stream->Read(&request)) frames += request.frames().frame_count();
  return frames;
}

v1::ClassifyContactResponse Answer(uint64_t sequence, uint64_t contact) {
  v1::ClassifyContactResponse response = testing::GoodAnswer(sequence);
  response.mutable_answer()->mutable_contacts(0)->set_id(contact);
  return response;
}

v1::ClassifyContactResponse Final(uint64_t sequence, uint64_t contact) {
  v1::ClassifyContactResponse response = Answer(sequence, contact);
  response.mutable_answer()->set_is_final(true);
  return response;
}

v1::ClassifyContactResponse Touched(uint64_t sequence, uint64_t contact) {
  v1::ClassifyContactResponse response = Answer(sequence, contact);
  v1::ContactEvent* event = response.mutable_answer()->add_events();
  event->set_kind(v1::ContactEvent::KIND_TOUCHED);
  event->set_contact_id(contact);
  return response;
}

TEST(SilentServerTest, LosesAllThatItNeverAcknowledges) {
  ScriptedServer server([](grpc::ServerContext*, Stream* stream) {
    stream->Write(testing::GoodStarted());
    stream->Write(Touched(1, 1));
    ReadAll(stream);
    return grpc::Status::OK;
  });
  const LoadReport report =
      RunTest(OptionsFor(server.address(), v1::RESULT_CADENCE_EVENTS));
  EXPECT_GE(report.sent, kRobots * 180u);
  EXPECT_EQ(report.answered, 0u);
  EXPECT_FALSE(report.ok());
}

TEST(SilentServerTest, IsFoundOutByTheContactsThatItNamesAtTheEnd) {
  ScriptedServer server([](grpc::ServerContext*, Stream* stream) {
    stream->Write(testing::GoodStarted());
    v1::ClassifyContactRequest request;
    stream->Read(&request);
    stream->Read(&request);
    stream->Write(Touched(1, 1));
    stream->Write(Final(1 + ReadAll(stream), 3));
    return grpc::Status::OK;
  });
  const LoadReport report =
      RunTest(OptionsFor(server.address(), v1::RESULT_CADENCE_EVENTS));
  EXPECT_EQ(report.lost(), 0u);
  // One of three contacts was reported, for each robot.
  EXPECT_EQ(report.unannounced, 2u * kRobots);
  EXPECT_FALSE(report.ok());
}

TEST(SlowServerTest, DelaysCountFromTheMessageOfTheFrame) {
  ScriptedServer server([](grpc::ServerContext*, Stream* stream) {
    stream->Write(testing::GoodStarted());
    v1::ClassifyContactRequest request;
    const uint64_t frames = ReadAll(stream);
    stream->Write(Touched(1, 1));
    stream->Write(Final(frames, 1));
    return grpc::Status::OK;
  });
  const LoadReport report =
      RunTest(OptionsFor(server.address(), v1::RESULT_CADENCE_EVENTS));
  EXPECT_TRUE(report.ok()) << report.first_error;
  EXPECT_EQ(report.answers, static_cast<uint64_t>(kRobots));
  // The first of at least 180 messages, 2.5 ms apart, is answered after the
  // last one.
  EXPECT_GE(report.p50_ms, 179 * 2.5);
}

}  // namespace
}  // namespace tactus::internal::client
