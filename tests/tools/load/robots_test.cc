// Robots of a load test that come and go, read slowly, touch as often as asked,
// and are spread over servers; against in-process servers.
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/random.h"
#include "google/protobuf/util/message_differencer.h"
#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"
#include "tools/load/load.h"
#include "tools/load/load_tally.h"

namespace tactus::internal::client {
namespace {

using testing::TestServer;

const FrameScript& Contacts() {
  static const FrameScript script =
      *FrameScript::Create({.untouched_seconds = 0.1, .contacts = 1});
  return script;
}

std::string AddressOf(TestServer& server) {
  return absl::StrCat("127.0.0.1:", server.server().ports()[0]);
}

LoadOptions OptionsFor(const std::vector<std::string>& servers) {
  return {.servers = servers,
          .robots = 4,
          .rate_hz = 400,
          .seconds = 0.5,
          .warm_up_seconds = 0,
          .cadence = v1::RESULT_CADENCE_EVENTS};
}

LoadReport Measure(const LoadOptions& options) {
  const auto report = RunLoad(options, Contacts());
  EXPECT_TRUE(report.ok()) << report.status();
  return report.ok() ? *report : LoadReport();
}

class RobotsTest : public ::testing::Test {
 protected:
  RobotsTest()
      : server_({.listen = {"127.0.0.1:0"}}),
        other_({.listen = {"127.0.0.1:0"}}) {}

  TestServer server_;
  TestServer other_;
};

TEST_F(RobotsTest, StreamsEndAndNewOnesBegin) {
  LoadOptions options = OptionsFor({AddressOf(server_)});
  options.arrivals_seconds = 0.1;
  uint64_t frames = 0;
  for (const int connections : {0, 2}) {
    for (const auto cadence :
         {v1::RESULT_CADENCE_EVENTS, v1::RESULT_CADENCE_EVERY_FRAME}) {
      options.connections = connections;
      options.cadence = cadence;
      const LoadReport report = Measure(options);
      // A stream lasts 0.05 to 0.15 s; the first of a robot is of any age.
      EXPECT_GE(report.streams, 4 * 3);
      EXPECT_LE(report.streams, 4 * (1 + 10));
      EXPECT_LE(report.lost(), report.superseded);
      EXPECT_EQ(report.unannounced, 0u);
      EXPECT_EQ(report.refused, 0) << report.first_error;
      EXPECT_EQ(report.failed, 0) << report.first_error;
      EXPECT_GT(report.final_p50_ms, 0);
      frames += report.sent;
      // The seed fixes when streams end.
      EXPECT_EQ(Measure(options).streams, report.streams);
      frames += report.sent;
    }
  }
  EXPECT_TRUE(testing::Eventually(
      [this] { return server_.server().gate().live() == 0; }));
  // Each stream got all of its frames, none of them twice.
  EXPECT_EQ(server_.server().gate().frames(), frames);
}

TEST_F(RobotsTest, SlowReadersMakeTheServerDropTheirAnswersOnly) {
  LoadOptions options = OptionsFor({AddressOf(server_)});
  options.cadence = v1::RESULT_CADENCE_EVERY_FRAME;
  options.rate_hz = 2000;
  options.seconds = 1;
  options.connections = 1;
  options.slow_readers = 1;
  const LoadReport report = Measure(options);
  // One answer is read in a second of 2,000; what fits into buffers waits.
  EXPECT_GT(report.slow_superseded, 500u);
  // The rest, and what the slow reader sent, is answered. A slow machine may
  // make the server drop answers of others.
  EXPECT_LE(report.lost(), report.superseded);
  EXPECT_EQ(report.sent, 4u * 2000);
  EXPECT_EQ(report.failed, 0) << report.first_error;
}

TEST_F(RobotsTest, AreSpreadOverServers) {
  for (const int connections : {0, 1, 4}) {
    LoadOptions options = OptionsFor({AddressOf(server_), AddressOf(other_)});
    options.connections = connections;
    const uint64_t before = server_.server().gate().frames();
    const uint64_t other_before = other_.server().gate().frames();
    const LoadReport report = Measure(options);
    EXPECT_TRUE(report.ok()) << report.first_error;
    EXPECT_TRUE(testing::Eventually([this] {
      return server_.server().gate().live() + other_.server().gate().live() ==
             0;
    }));
    const uint64_t frames = server_.server().gate().frames() - before;
    const uint64_t other = other_.server().gate().frames() - other_before;
    EXPECT_EQ(frames + other, report.sent);
    // Robots leave in the last tenth.
    EXPECT_NEAR(frames, report.sent / 2, report.sent / 10) << connections;
  }
}

TEST_F(RobotsTest, OneServerOfTwoIsDown) {
  const LoadOptions options =
      OptionsFor({AddressOf(server_), "unix:/no/such/socket"});
  const LoadReport report = Measure(options);
  EXPECT_EQ(report.refused, 2);
  EXPECT_FALSE(report.ok());
  EXPECT_EQ(report.lost(), 0u);
  EXPECT_GT(report.sent, 0u);
}

// Frames of a script with a taxel at 0.1 N or more.
double PressedFrames(const FrameScript& script) {
  const double newton = 1 / script.config().scale();
  int pressed = 0;
  for (size_t i = 0; i < script.size(); ++i) {
    std::string bytes;
    script.AppendMessage(i, 1 + i, &bytes);
    v1::ClassifyContactRequest request;
    EXPECT_TRUE(request.ParseFromString(bytes));
    const std::string& taxels = request.frames().taxels();
    bool is_pressed = false;
    for (size_t k = 0; k + 1 < taxels.size(); k += 2) {
      const int value = static_cast<uint8_t>(taxels[k]) +
                        256 * static_cast<uint8_t>(taxels[k + 1]);
      is_pressed = is_pressed || value >= 0.1 * newton;
    }
    pressed += is_pressed;
  }
  return pressed;
}

TEST(TouchedFractionTest, IsThatOfTheFrames) {
  const auto script = [](double fraction) {
    return *FrameScript::Create({.touched_fraction = fraction, .contacts = 2});
  };
  const FrameScript all = script(1);
  const double pressed = PressedFrames(all);
  EXPECT_GT(pressed, 0.5 * static_cast<double>(all.size()));
  EXPECT_EQ(PressedFrames(script(0)), 0);
  for (const double fraction : {0.05, 0.3, 0.8}) {
    const FrameScript some = script(fraction);
    // The same contacts, with more or fewer frames between them.
    EXPECT_EQ(PressedFrames(some), pressed);
    EXPECT_NEAR(static_cast<double>(all.size()) / fraction,
                static_cast<double>(some.size()), 1)
        << fraction;
    EXPECT_NEAR(some.touched_fraction(), fraction, 1e-3);
  }
  for (const double wrong : {-0.1, 0.001, 1.1}) {
    EXPECT_FALSE(FrameScript::Create({.touched_fraction = wrong}).ok());
  }
}

TEST(TallyTest, AddedTalliesAreThoseOfOneTest) {
  Random random(5);
  LoadTally one, two, all;
  for (int i = 0; i < 1000; ++i) {
    const auto delay_ns = static_cast<int64_t>(1e9 * random.Uniform());
    LoadTally& part = i % 3 == 0 ? one : two;
    part.answer_delay.Add(delay_ns);
    all.answer_delay.Add(delay_ns);
    part.send_delay.Add(delay_ns / 7);
    all.send_delay.Add(delay_ns / 7);
  }
  one.sent = 3;
  two.sent = 4;
  two.answered = 2;
  two.first_error = "two \"quoted\"\n";
  one.elapsed_s = 2;
  two.elapsed_s = 1.5;
  one.cpu_s = two.cpu_s = 0.5;
  all.sent = 7;
  all.answered = 2;
  all.first_error = two.first_error;
  all.elapsed_s = 2;
  all.cpu_s = 1;
  // As a process writes it.
  const std::string line = TallyToText(two);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  LoadTally read;
  ASSERT_TRUE(ReadTally(line, &read).ok());
  one.Add(read);
  EXPECT_EQ(LoadToJson(ReportOf(one)), LoadToJson(ReportOf(all)));
  EXPECT_EQ(TallyToText(one), TallyToText(all));
  for (const char* wrong : {"", "{}", "[1]", "tactus-load: no"}) {
    LoadTally tally;
    EXPECT_FALSE(ReadTally(wrong, &tally).ok()) << wrong;
  }
}

}  // namespace
}  // namespace tactus::internal::client
