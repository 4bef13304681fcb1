// SocketCan against a kernel that the test plays, and what this machine's
// kernel answers.
#include "client/drivers/can/socket_can.h"

#include <linux/can.h>
#include <linux/can/error.h>

#include <cerrno>
#include <cstring>
#include <deque>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/memory_bus.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;

constexpr int64_t kRealtimeNs = 1'800'000'000'000'000'000;

// Plays the kernel.
class ScriptedSockets : public CanSockets {
 public:
  explicit ScriptedSockets(ManualClock* clock) : clock_(clock) {}

  int open_result = 3;
  int write_result = 0;
  // Writes that fail with -ENOBUFS first.
  int full_writes = 0;
  int restart_result = 0;
  int restarts = 0;
  int open_sockets = 0;
  std::deque<Message> messages;
  // What Read returns when there are no messages.
  int read_result = 0;
  std::vector<can_frame> written;

  // A frame that the kernel received `age_ns` ago.
  void Push(uint32_t id, std::initializer_list<uint8_t> data,
            int64_t age_ns = 0, uint32_t dropped = 0) {
    can_frame raw = {};
    raw.can_id = id;
    raw.can_dlc = static_cast<uint8_t>(data.size());
    std::copy(data.begin(), data.end(), raw.data);
    Message message;
    std::memcpy(message.bytes.data(), &raw, sizeof(raw));
    message.size = sizeof(raw);
    message.realtime_ns = RealtimeNs() - age_ns;
    message.dropped = dropped;
    messages.push_back(message);
  }

  int Open(const std::string&, std::span<const CanFilter>) override {
    if (open_result >= 0) ++open_sockets;
    return open_result;
  }
  void Close(int) override { --open_sockets; }
  int Wait(int, int64_t timeout_ns) override {
    clock_->SleepNs(timeout_ns);
    return 0;
  }
  int Read(int, Message& message) override {
    if (messages.empty()) return read_result;
    message = messages.front();
    messages.pop_front();
    return 1;
  }
  int Write(int, std::span<const uint8_t> bytes) override {
    if (full_writes > 0) {
      --full_writes;
      return -ENOBUFS;
    }
    can_frame raw;
    EXPECT_EQ(bytes.size(), sizeof(raw));
    std::memcpy(&raw, bytes.data(), sizeof(raw));
    written.push_back(raw);
    return write_result;
  }
  int Restart(const std::string&) override {
    ++restarts;
    return restart_result;
  }
  int64_t RealtimeNs() override { return kRealtimeNs + clock_->NowNs(); }

 private:
  ManualClock* const clock_;
};

class SocketCanTest : public ::testing::Test {
 protected:
  ManualClock clock_;
  ScriptedSockets sockets_{&clock_};
  SocketCan bus_{"can7", &sockets_, &clock_};
  CanFrame frame_;
};

TEST_F(SocketCanTest, FramesCarryTheKernelsTimeOnTheDriversClock) {
  ASSERT_TRUE(bus_.Open({}).ok());
  sockets_.Push(0x4D5, {0x40, 1, 2}, /*age_ns=*/3'000'000);
  ASSERT_EQ(*bus_.Receive(frame_, 1'000), true);
  EXPECT_EQ(frame_.id, 0x4D5u);
  EXPECT_EQ(frame_.size, 3);
  EXPECT_EQ(frame_.data[2], 2);
  EXPECT_FALSE(frame_.extended);
  EXPECT_EQ(frame_.time_ns, clock_.NowNs() - 3'000'000);
  // The clock of the day was set: the time of reading is used.
  clock_.SleepNs(5);
  sockets_.Push(0x4D5, {1}, /*age_ns=*/-500'000'000);
  ASSERT_EQ(*bus_.Receive(frame_, 1'000), true);
  EXPECT_EQ(frame_.time_ns, clock_.NowNs());
  // Times never fall.
  const int64_t before = frame_.time_ns;
  sockets_.Push(0x80001234 | CAN_EFF_FLAG, {1}, /*age_ns=*/7'000'000);
  ASSERT_EQ(*bus_.Receive(frame_, 1'000), true);
  EXPECT_EQ(frame_.time_ns, before);
  EXPECT_TRUE(frame_.extended);
  EXPECT_EQ(frame_.id, 0x1234u);
}

TEST_F(SocketCanTest, ReceiveEndsInTime) {
  ASSERT_TRUE(bus_.Open({}).ok());
  const int64_t begin_ns = clock_.NowNs();
  EXPECT_EQ(*bus_.Receive(frame_, 100'000'000), false);
  EXPECT_EQ(clock_.NowNs() - begin_ns, 100'000'000);
  EXPECT_EQ(bus_.counters().received, 0u);
}

TEST_F(SocketCanTest, ErrorFramesAreCountedAndBusOffEndsTheBus) {
  ASSERT_TRUE(bus_.Open({}).ok());
  sockets_.Push(CAN_ERR_FLAG | CAN_ERR_PROT, {0, 0, 8, 0, 0, 0, 0, 0});
  sockets_.Push(CAN_ERR_FLAG | CAN_ERR_CRTL,
                {0, CAN_ERR_CRTL_RX_OVERFLOW, 0, 0, 0, 0, 0, 0});
  sockets_.Push(0x410, {1});
  ASSERT_EQ(*bus_.Receive(frame_, 1'000), true);
  EXPECT_EQ(bus_.counters().error_frames, 2u);
  EXPECT_EQ(bus_.counters().overruns, 1u);
  sockets_.Push(CAN_ERR_FLAG | CAN_ERR_BUSOFF, {0, 0, 0, 0, 0, 0, 0, 0});
  const absl::Status status = bus_.Receive(frame_, 1'000).status();
  EXPECT_EQ(ReasonOf(status), "IO");
  EXPECT_THAT(std::string(status.message()), HasSubstr("can7: bus-off"));
  EXPECT_EQ(bus_.counters().bus_offs, 1u);
  // Opening again restarts the controller, once.
  ASSERT_TRUE(bus_.Open({}).ok());
  EXPECT_EQ(sockets_.restarts, 1);
  ASSERT_TRUE(bus_.Open({}).ok());
  EXPECT_EQ(sockets_.restarts, 1);
  EXPECT_EQ(sockets_.open_sockets, 1);
}

TEST_F(SocketCanTest, WithoutTheRightToRestartTheKernelDoesIt) {
  ASSERT_TRUE(bus_.Open({}).ok());
  sockets_.Push(CAN_ERR_FLAG | CAN_ERR_BUSOFF, {0, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_FALSE(bus_.Receive(frame_, 1'000).ok());
  sockets_.restart_result = -EPERM;
  EXPECT_TRUE(bus_.Open({}).ok());
}

TEST_F(SocketCanTest, FramesThatTheKernelDroppedAreCounted) {
  ASSERT_TRUE(bus_.Open({}).ok());
  sockets_.Push(0x410, {1}, 0, 0);
  sockets_.Push(0x410, {1}, 0, 7);
  sockets_.Push(0x410, {1}, 0, 7);
  for (int i = 0; i < 3; ++i) ASSERT_EQ(*bus_.Receive(frame_, 1'000), true);
  EXPECT_EQ(bus_.counters().overruns, 1u);
}

TEST_F(SocketCanTest, WhatIsNoFrameIsCounted) {
  ASSERT_TRUE(bus_.Open({}).ok());
  sockets_.Push(0x410, {1});
  sockets_.messages.back().size = 7;
  sockets_.Push(0x410, {1});
  sockets_.messages.back().bytes[4] = 9;
  EXPECT_EQ(*bus_.Receive(frame_, 1'000), false);
  EXPECT_EQ(bus_.counters().malformed, 2u);
}

TEST_F(SocketCanTest, AFullQueueIsWaitedForButNotForEver) {
  ASSERT_TRUE(bus_.Open({}).ok());
  sockets_.full_writes = 3;
  EXPECT_TRUE(bus_.Send(MakeCanFrame(0x201, {7, 0})).ok());
  ASSERT_EQ(sockets_.written.size(), 1u);
  EXPECT_EQ(sockets_.written[0].can_id, 0x201u);
  EXPECT_EQ(sockets_.written[0].can_dlc, 2);
  sockets_.full_writes = 1'000;
  const absl::Status status = bus_.Send(MakeCanFrame(0x201, {7, 0}));
  EXPECT_THAT(std::string(status.message()), HasSubstr("nobody on the bus"));
}

TEST_F(SocketCanTest, ErrorsNameTheInterfaceAndWhatToDo) {
  const std::pair<int, const char*> cases[] = {
      {-ENODEV, "no such interface"},
      {-ENETDOWN, "the interface is down"},
      {-EAFNOSUPPORT, "this kernel has no CAN"}};
  for (const auto& [error, text] : cases) {
    sockets_.open_result = error;
    const absl::Status status = bus_.Open({});
    EXPECT_EQ(ReasonOf(status), "IO");
    EXPECT_THAT(std::string(status.message()), HasSubstr("can7: open"));
    EXPECT_THAT(std::string(status.message()), HasSubstr(text));
  }
  sockets_.open_result = 3;
  ASSERT_TRUE(bus_.Open({}).ok());
  // The adapter is pulled out: the kernel removes the interface.
  sockets_.read_result = -ENETDOWN;
  EXPECT_EQ(ReasonOf(bus_.Receive(frame_, 1'000).status()), "IO");
  bus_.Close();
  EXPECT_EQ(ReasonOf(bus_.Receive(frame_, 1'000).status()), "IO");
  EXPECT_EQ(ReasonOf(bus_.Send(frame_)), "IO");
  EXPECT_EQ(sockets_.open_sockets, 0);
}

TEST(CanSocketsTest, AnInterfaceThatIsNotThereIsAnError) {
  SocketCan bus("nosuchcan0");
  const absl::Status status = bus.Open({});
  EXPECT_EQ(ReasonOf(status), "IO");
  EXPECT_THAT(std::string(status.message()), HasSubstr("nosuchcan0: open"));
}

}  // namespace
}  // namespace tactus::internal::client
