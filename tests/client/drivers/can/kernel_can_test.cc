// SocketCan on the kernel's CAN: vcan0, and can0 and can1 on one bus. Runs in
// the guest of tests/vm/run.sh; elsewhere it is skipped.
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "client/drivers/can/socket_can.h"
#include "client/drivers/can_skin_driver.h"
#include "client/drivers/icub_skin/icub_skin.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/driver_cost.h"
#include "tools/fakeskin/play_peer.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;

bool HasInterface(const std::string& name) {
  return std::filesystem::exists("/sys/class/net/" + name);
}

int RunCommand(const std::string& command) {
  return std::system(command.c_str());
}

// Two ends of one bus: both on vcan0, or one on each card.
class KernelCanTest
    : public ::testing::TestWithParam<std::pair<const char*, const char*>> {
 protected:
  void SetUp() override {
    for (const char* name : {GetParam().first, GetParam().second}) {
      if (!HasInterface(name)) {
        GTEST_SKIP() << "needs the CAN interface " << name
                     << ": run tests/vm/run.sh";
      }
    }
  }

  CanFrame frame_;
};

constexpr int64_t kSecondNs = 1'000'000'000;

TEST_P(KernelCanTest, FramesFiltersAndTimes) {
  SocketCan sender(GetParam().first);
  SocketCan receiver(GetParam().second);
  const CanFilter filters[] = {{.id = 0x400, .mask = 0x700}};
  ASSERT_TRUE(sender.Open({}).ok());
  const absl::Status opened = receiver.Open(filters);
  ASSERT_TRUE(opened.ok()) << opened;
  Clock& clock = Clock::System();
  // The kernel switches its stamps on a moment after the first socket that
  // wants them.
  clock.SleepNs(100'000'000);
  ASSERT_TRUE(sender.Send(MakeCanFrame(0x310, {1})).ok());
  const int64_t before_ns = clock.NowNs();
  const CanFrame wanted = MakeCanFrame(0x4D5, {0x40, 1, 2, 3, 4, 5, 6, 7});
  ASSERT_TRUE(sender.Send(wanted).ok());
  // The stamp is that of the receipt, not of a later read.
  clock.SleepNs(300'000'000);
  const int64_t read_ns = clock.NowNs();
  const auto received = receiver.Receive(frame_, kSecondNs);
  ASSERT_TRUE(received.ok()) << received.status();
  ASSERT_TRUE(*received);
  EXPECT_TRUE(frame_.SameAs(wanted)) << std::hex << frame_.id;
  EXPECT_GE(frame_.time_ns, before_ns - 1'000'000);
  EXPECT_LT(frame_.time_ns, read_ns - 200'000'000);
  EXPECT_FALSE(*receiver.Receive(frame_, 10'000'000));
}

TEST_P(KernelCanTest, AnInterfaceThatGoesDownIsABreakAndComesBack) {
  const std::string name = GetParam().second;
  SocketCan bus(name);
  ASSERT_TRUE(bus.Open({}).ok());
  ASSERT_EQ(RunCommand("ip link set " + name + " down"), 0);
  const absl::Status down = bus.Receive(frame_, kSecondNs).status();
  EXPECT_EQ(ReasonOf(down), "IO");
  EXPECT_THAT(std::string(down.message()), HasSubstr("the interface is down"));
  ASSERT_EQ(RunCommand("ip link set " + name + " up"), 0);
  EXPECT_TRUE(bus.Open({}).ok());
  EXPECT_FALSE(*bus.Receive(frame_, 10'000'000));
}

// 24 triangles at 100 Hz: 4,800 frames a second.
TEST_P(KernelCanTest, AForearmAt100HzLosesNothing) {
  const auto list = *icub::ParseBoards("forearm-v2");
  std::atomic<bool> stop = false;
  NumberedScans scans;
  std::thread player([&] {
    IcubBoards boards(list, scans.Source());
    SocketCan bus(GetParam().first);
    const absl::Status played =
        PlayPeer(boards, bus, Clock::System(), [&] { return !stop; });
    EXPECT_TRUE(played.ok()) << played;
  });
  SocketCan bus(GetParam().second);
  icub::IcubSkin skin(*icub::PortPatch(list), {.period_ms = 10});
  CanSkinDriver driver(&bus, &skin, {});
  const auto cost = MeasureDriver(driver, scans, 1'000);
  EXPECT_TRUE(cost.ok()) << cost.status();
  if (cost.ok()) {
    std::printf("24 triangles at 100 Hz over %s: %s\n", GetParam().second,
                cost->Text().c_str());
    EXPECT_EQ(cost->missing, 0u);
    EXPECT_EQ(cost->incomplete, 0u);
    EXPECT_EQ(cost->overwritten, 0u);
    EXPECT_EQ(bus.counters().overruns, 0u);
  }
  stop = true;
  player.join();
}

INSTANTIATE_TEST_SUITE_P(Interfaces, KernelCanTest,
                         ::testing::Values(std::pair("vcan0", "vcan0"),
                                           std::pair("can0", "can1")),
                         [](const auto& info) {
                           return std::string(info.param.second);
                         });

// A restart of a controller that is not bus-off is refused by the kernel; that
// it is refused for this reason shows that the request is understood.
TEST(KernelCanRestartTest, TheKernelUnderstandsTheRequest) {
  if (!HasInterface("can0")) {
    GTEST_SKIP() << "needs the CAN interface can0: run tests/vm/run.sh";
  }
  const int result = CanSockets::System().Restart("can0");
  EXPECT_TRUE(result == -EBUSY || result == -EINVAL) << result;
  EXPECT_EQ(CanSockets::System().Restart("nosuchcan0"), -ENODEV);
}

}  // namespace
}  // namespace tactus::internal::client
