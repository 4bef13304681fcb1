// A trial was counted twice: under the limit on streams, and in the arrival
// gate until it ended. A trial whose answer nobody reads does not end, so 1,000
// of them from one peer took half of the places for calls that arrive, those of
// health checks included. Nothing ended such a trial while its connection was
// open.
#include "gtest/gtest.h"
#include "tests/support/bystander.h"
#include "tests/support/raw_http2.h"

namespace tactus::internal {
namespace {

using std::chrono::milliseconds;
using testing::Eventually;
using testing::RawHttp2;
using testing::TestServer;

constexpr char kClassifyTrial[] = "/tactus.v1.ContactService/ClassifyTrial";
constexpr int kTrials = 100;

v1::ClassifyTrialRequest TrialRequest() {
  v1::ClassifyTrialRequest request;
  *request.mutable_config() = testing::ConfigRequest().config();
  uint64_t sequence = 0;
  for (const testing::Counts& frame : testing::Contact(5, 1)) {
    *request.add_frames() = testing::DenseU16(++sequence, {frame}).frames();
  }
  return request;
}

// Sends kTrials trials and lets the server send no answer.
void SendTrials(RawHttp2& attacker) {
  // SETTINGS_INITIAL_WINDOW_SIZE = 0: the server may send headers but no data.
  attacker.Frame(RawHttp2::kSettings, 0, 0, std::string("\0\4\0\0\0\0", 6));
  const std::string trial = TrialRequest().SerializeAsString();
  for (int i = 0; i < kTrials; ++i) {
    const uint32_t call = attacker.Open(kClassifyTrial);
    ASSERT_TRUE(attacker.Message(call, trial));
    attacker.Frame(RawHttp2::kData, RawHttp2::kEndStream, call, "");
  }
  ASSERT_TRUE(attacker.Flush());
}

// The arrival gate counts calls that no other limit counts. The limit on
// streams counts these trials.
TEST(TrialsWithoutAReaderTest, LeaveTheArrivalGate) {
  TestServer server(TestServer::OnLoopback(100));
  const int port = server.server().ports()[0];
  testing::Bystander robot(absl::StrCat("127.0.0.1:", port), "");
  ASSERT_TRUE(robot.IsServed());
  RawHttp2 attacker(port);
  SendTrials(attacker);
  const auto& gate = server.server().gate();
  // The trials and the robot's stream.
  ASSERT_TRUE(attacker.ReadUntil([&] { return gate.live() == kTrials + 1; },
                                 milliseconds(30'000)));
  EXPECT_TRUE(
      Eventually([&] { return server.server().arrivals().taken() == 0; }));
  EXPECT_EQ(gate.live(), kTrials + 1);
  EXPECT_TRUE(robot.IsServed());
  testing::ExpectGoodStream(server.channel());
  EXPECT_TRUE(robot.Finish().ok());
}

TEST(TrialsWithoutAReaderTest, EndAfterTheIdleTimeout) {
  server::TactusServer::Options options = TestServer::OnLoopback(100);
  options.idle_timeout_ms = 200;
  TestServer server(options);
  RawHttp2 attacker(server.server().ports()[0]);
  SendTrials(attacker);
  const auto& gate = server.server().gate();
  ASSERT_TRUE(attacker.ReadUntil([&] { return gate.opened() == kTrials; },
                                 milliseconds(30'000)));
  EXPECT_TRUE(attacker.ReadUntil([&] { return gate.live() == 0; },
                                 milliseconds(10'000)));
  EXPECT_TRUE(attacker.open());
}

}  // namespace
}  // namespace tactus::internal
