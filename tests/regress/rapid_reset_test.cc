// A client that opened calls and reset each at once (HTTP/2 "rapid reset") made
// calls faster than the server took them: 60,000 of them, 9.4 MB in 0.6 s, took
// 810 MB. A reset call frees its place under the limit on concurrent streams,
// so that limit does not help.
#include <memory>
#include <thread>
#include <vector>

#include "gtest/gtest.h"
#include "server/ops/arrival_gate.h"
#include "tests/support/bystander.h"
#include "tests/support/child_tactusd.h"
#include "tests/support/raw_http2.h"

namespace tactus::internal {
namespace {

using std::chrono::milliseconds;
using testing::Bystander;
using testing::ChildTactusd;
using testing::RawHttp2;

constexpr int kCallsPerAttacker = 30'000;
constexpr double kMostMibAfterResets = 250;

// Opens and resets calls of all kinds, as fast as the server reads.
void Attack(int port) {
  constexpr const char* kMethods[] = {
      "/tactus.v1.ContactService/ClassifyContact", "/no.such.Service/Method"};
  RawHttp2 attacker(port);
  for (int i = 0; i < kCallsPerAttacker; ++i) {
    attacker.Reset(attacker.Open(kMethods[i % 2]));
  }
  attacker.Flush();
  attacker.ReadFor(milliseconds(100));
}

// While the server still ends the attacker's calls, it may refuse new ones.
void ExpectServedSoon(const ChildTactusd& server) {
  EXPECT_TRUE(testing::Eventually([&] {
    Bystander late(server.address());
    return late.IsServed(1);
  }));
}

class RapidResetsTest : public ::testing::TestWithParam<int> {};

TEST_P(RapidResetsTest, LeavesMemoryAndOthersAlone) {
  ChildTactusd server({"--log-level=warn"});
  ASSERT_NE(server.port(), 0);
  Bystander robot(server.address());
  ASSERT_TRUE(robot.IsServed());
  const double before = server.ResidentMib();
  std::vector<std::thread> attackers;
  for (int i = 0; i < GetParam(); ++i) {
    attackers.emplace_back(Attack, server.port());
  }
  EXPECT_TRUE(robot.IsServed());
  for (std::thread& attacker : attackers) attacker.join();
  EXPECT_TRUE(robot.IsServed());
  EXPECT_TRUE(server.PeakIsBelow(kMostMibAfterResets));
  EXPECT_TRUE(testing::Eventually(
      [&] { return bool{server.ResidentIsBelow(before + 50)}; }));
  ExpectServedSoon(server);
  EXPECT_TRUE(robot.Finish().ok());
  RecordProperty("peak_mib", static_cast<int>(server.PeakMib()));
}

// Its connection is closed, before so many calls wait that the gate must refuse
// those of others.
TEST(RapidResetTest, TheConnectionIsClosed) {
  ChildTactusd server({"--log-level=warn"});
  ASSERT_NE(server.port(), 0);
  Attack(server.port());
  EXPECT_TRUE(testing::Eventually([&] {
    return server.Log().find("too many RST_STREAM frames") != std::string::npos;
  })) << server.Log();
  EXPECT_EQ(server.Log().find("calls arrive faster"), std::string::npos);
  ExpectServedSoon(server);
}

INSTANTIATE_TEST_SUITE_P(Attackers, RapidResetsTest, ::testing::Values(1, 4));

constexpr int64_t kMs = 1'000'000;

TEST(ArrivalGateTest, RefusesWhenTooManyWait) {
  server::ArrivalGate gate(2);
  EXPECT_TRUE(gate.TryEnter(1000 * kMs));
  EXPECT_TRUE(gate.TryEnter(1000 * kMs));
  // One in 10 ms passes at the limit, so that a wrong count corrects itself.
  EXPECT_TRUE(gate.TryEnter(1000 * kMs));
  EXPECT_FALSE(gate.TryEnter(1009 * kMs));
  EXPECT_TRUE(gate.TryEnter(1010 * kMs));
  EXPECT_EQ(gate.refused(), 1u);
  EXPECT_EQ(gate.waiting(), 4);
  gate.Take(1010 * kMs, 1011 * kMs);
  EXPECT_EQ(gate.waiting(), 3);
  EXPECT_EQ(gate.taken(), 1);
}

TEST(ArrivalGateTest, AnOldRequestShowsThatNothingWaited) {
  server::ArrivalGate gate(2);
  for (int i = 0; i < 3; ++i) gate.TryEnter(0);
  gate.Take(0, 101 * kMs);
  EXPECT_EQ(gate.waiting(), 0);
  gate.Take(101 * kMs, 102 * kMs);
  EXPECT_EQ(gate.waiting(), 0);
}

TEST(ArrivalGateTest, CallsCountUntilTheyEnd) {
  server::ArrivalGate gate(1);
  {
    server::ArrivalGate::Request first(&gate);
    const server::ArrivalGate::Request second(&gate);
    first.Arrive();
    EXPECT_EQ(gate.taken(), 1);
    // The extra call of these 10 ms, and then none.
    EXPECT_TRUE(gate.TryEnter(1000 * kMs));
    EXPECT_FALSE(gate.TryEnter(1000 * kMs));
    first.Admit();
    EXPECT_EQ(gate.taken(), 0);
  }
  EXPECT_EQ(gate.taken(), 0);
}

}  // namespace
}  // namespace tactus::internal
