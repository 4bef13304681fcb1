// Lines of joint values, and datagrams of them over the loopback interface.
#include "client/kinematics/joint_receiver.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/kinematics/joint_line.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/kinematics/fake_arm.h"

namespace tactus::internal::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(JointLineTest, NumbersBetweenWhiteSpaceAreRead) {
  std::vector<double> values(3);
  int64_t time_ns = 0;
  for (const char* line :
       {"123456789012345678 1 -2.5 3e-3", "123456789012345678\t1 -2.5 3e-3\r\n",
        "  123456789012345678   1.0  -2.5 0.003 \n\n"}) {
    values.assign(3, 7);
    const absl::Status status = ParseJointLine(line, time_ns, values);
    ASSERT_TRUE(status.ok()) << status;
    EXPECT_EQ(time_ns, 123456789012345678);
    EXPECT_THAT(values, ElementsAre(1, -2.5, 0.003));
  }
}

TEST(JointLineTest, WhatIsWrongIsNamed) {
  std::vector<double> values(2);
  int64_t time_ns = 0;
  const auto error = [&](absl::string_view line) {
    const absl::Status status = ParseJointLine(line, time_ns, values);
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << line;
    return std::string(status.message());
  };
  EXPECT_THAT(error(""), HasSubstr("time"));
  EXPECT_THAT(error("1.5 0 0"), HasSubstr("\"1.5\""));
  EXPECT_THAT(error("99999999999999999999 0 0"), HasSubstr("time"));
  EXPECT_THAT(error("1 0"), HasSubstr("is 1; it must be 2"));
  EXPECT_THAT(error("1 0 0 0 0"), HasSubstr("is 4; it must be 2"));
  EXPECT_THAT(error("1 0 x"), HasSubstr("joint value 2 is \"x\""));
  EXPECT_THAT(error("1 0,0 0"), HasSubstr("joint value 1"));
  EXPECT_THAT(error(absl::string_view("1 0\0 0", 6)),
              HasSubstr("joint value 1"));
}

// Its time is set by hand.
class HandClock : public Clock {
 public:
  int64_t NowNs() override { return now_ns; }
  void SleepNs(int64_t duration_ns) override { now_ns += duration_ns; }

  std::atomic<int64_t> now_ns = 5'000'000'000;
};

class Sender {
 public:
  explicit Sender(int port) {
    to_.sin_family = AF_INET;
    to_.sin_port = htons(static_cast<uint16_t>(port));
    to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  }
  ~Sender() { close(socket_); }

  void Send(const std::string& text) {
    EXPECT_EQ(sendto(socket_, text.data(), text.size(), 0,
                     reinterpret_cast<sockaddr*>(&to_), sizeof(to_)),
              static_cast<ssize_t>(text.size()));
  }

 private:
  const int socket_ = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to_ = {};
};

JointReceiver::Statistics AfterDatagrams(const JointReceiver& receiver,
                                         uint64_t count) {
  for (int i = 0; i < 2000; ++i) {
    const JointReceiver::Statistics s = receiver.statistics();
    if (s.taken + s.refused >= count) return s;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ADD_FAILURE() << "datagrams are missing";
  return receiver.statistics();
}

TEST(JointReceiverTest, DatagramsBecomePoses) {
  HandClock clock;
  JointPoses poses{FakeArm()};
  const auto receiver = JointReceiver::Listen("127.0.0.1:0", &poses, &clock);
  ASSERT_TRUE(receiver.ok()) << receiver.status();
  Sender sender((*receiver)->port());
  sender.Send("4990000000 0.1 1\n");
  sender.Send("5000000000 0.2 1\n");
  EXPECT_EQ(AfterDatagrams(**receiver, 2).taken, 2u);
  auto pose = poses.PoseAt(4'995'000'000);
  ASSERT_TRUE(pose) << poses.Problem();
  EXPECT_NEAR(pose->position.x(), 0.15, 1e-12);
  // 0 is the time of receipt.
  clock.now_ns = 5'010'000'000;
  sender.Send("0 0.3 1");
  AfterDatagrams(**receiver, 3);
  pose = poses.PoseAt(5'010'000'000);
  ASSERT_TRUE(pose) << poses.Problem();
  EXPECT_NEAR(pose->position.x(), 0.3, 1e-12);
}

TEST(JointReceiverTest, WrongDatagramsAreCountedAndTheReasonIsKept) {
  HandClock clock;
  JointPoses poses{FakeArm()};
  const auto receiver = JointReceiver::Listen("127.0.0.1:0", &poses, &clock);
  ASSERT_TRUE(receiver.ok()) << receiver.status();
  Sender sender((*receiver)->port());
  const std::pair<std::string, std::string> wrong[] = {
      {"", "time"},
      {"4990000000 0.1", "is 1; it must be 2"},
      {"4990000000 0.1 nan", "joint turn"},
      {"4990000000 9 0", "its limits"},
      // Unix time.
      {"1763867000000000000 0 0", "CLOCK_MONOTONIC"},
      {"3999999999 0 0", "CLOCK_MONOTONIC"},
      {"-9223372036854775808 0 0", "CLOCK_MONOTONIC"},
      {"4990000000 0 0" + std::string(5000, ' '), "bytes of a datagram"},
  };
  uint64_t count = 0;
  for (const auto& [line, reason] : wrong) {
    sender.Send(line);
    const JointReceiver::Statistics s = AfterDatagrams(**receiver, ++count);
    EXPECT_EQ(s.refused, count);
    EXPECT_TRUE(s.refusing);
    EXPECT_THAT(s.last_refusal, HasSubstr(reason)) << line;
  }
  sender.Send("4990000000 0 0");
  const JointReceiver::Statistics s = AfterDatagrams(**receiver, ++count);
  EXPECT_EQ(s.taken, 1u);
  EXPECT_FALSE(s.refusing);
}

TEST(JointReceiverTest, AddressesThatCannotBeUsedAreErrors) {
  JointPoses poses{FakeArm()};
  EXPECT_EQ(ReasonOf(JointReceiver::Listen("5005", &poses).status()),
            "INVALID_CONFIG");
  const auto first = JointReceiver::Listen("127.0.0.1:0", &poses);
  ASSERT_TRUE(first.ok()) << first.status();
  const auto second = JointReceiver::Listen(
      absl::StrCat("127.0.0.1:", (*first)->port()), &poses);
  EXPECT_EQ(ReasonOf(second.status()), "IO");
  EXPECT_THAT(std::string(second.status().message()), HasSubstr("in use"));
}

}  // namespace
}  // namespace tactus::internal::client
