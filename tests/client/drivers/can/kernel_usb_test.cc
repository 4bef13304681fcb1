// A gs_usb adapter that this process plays through FunctionFS, as the kernel's
// USB stack sees it: read by our driver through libusb and usbfs, and by the
// kernel's driver and SocketCan. Runs in the guest of tests/vm/run.sh, which
// makes the gadget; elsewhere it is skipped.
#include <libusb.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "client/drivers/can/gs_usb.h"
#include "client/drivers/can/socket_can.h"
#include "client/drivers/can_skin_driver.h"
#include "client/drivers/icub_skin/icub_skin.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/driver_cost.h"
#include "tools/fakeskin/gs_usb_gadget.h"
#include "tools/fakeskin/play_peer.h"

namespace tactus::internal::client {
namespace {

using ::testing::HasSubstr;

constexpr char kGadget[] = "/sys/kernel/config/usb_gadget/skin";
constexpr char kFunctionFs[] = "/tmp/skin-function";

// The CAN interface of the kernel's gs_usb driver; empty if there is none
// within 10 s.
std::string GsUsbInterface() {
  for (int i = 0; i < 100; ++i) {
    for (const auto& entry :
         std::filesystem::directory_iterator("/sys/class/net")) {
      std::error_code error;
      const auto driver = std::filesystem::read_symlink(
          entry.path() / "device" / "driver", error);
      if (!error && driver.filename() == "gs_usb") {
        return entry.path().filename();
      }
    }
    Clock::System().SleepNs(100'000'000);
  }
  return "";
}

// The adapter as another program opens it, which takes it from the kernel's
// driver meanwhile.
class OpenedAdapter {
 public:
  OpenedAdapter() {
    if (libusb_init(&context_) != 0) return;
    device_ = libusb_open_device_with_vid_pid(context_, 0x1d50, 0x606f);
    libusb_set_auto_detach_kernel_driver(device_, 1);
  }
  ~OpenedAdapter() {
    if (device_ != nullptr) libusb_close(device_);
    if (context_ != nullptr) libusb_exit(context_);
  }
  OpenedAdapter(const OpenedAdapter&) = delete;
  OpenedAdapter& operator=(const OpenedAdapter&) = delete;

  // Ends all transfers and begins anew, in one step.
  bool ResetInterface() {
    return libusb_claim_interface(device_, 0) == 0 &&
           libusb_set_interface_alt_setting(device_, 0, 0) == 0 &&
           libusb_release_interface(device_, 0) == 0;
  }
  bool ResetDevice() { return libusb_reset_device(device_) == 0; }

 private:
  libusb_context* context_ = nullptr;
  libusb_device_handle* device_ = nullptr;
};

// The boards of a forearm behind the adapter, in a thread.
class PlayedAdapter {
 public:
  explicit PlayedAdapter(const std::vector<icub::SkinBoard>& boards,
                         IcubBoards::Source source)
      : thread_([this, boards, source = std::move(source)] {
          IcubBoards skin(boards, source);
          GsUsbGadget bus({.directory = kFunctionFs, .gadget = kGadget});
          const absl::Status played =
              PlayPeer(skin, bus, Clock::System(), [this] { return !stop_; });
          EXPECT_TRUE(played.ok()) << played;
          EXPECT_EQ(bus.counters().overruns, 0u);
          EXPECT_EQ(bus.counters().malformed, 0u);
        }) {}
  ~PlayedAdapter() {
    stop_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

class KernelUsbTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kGadget)) {
      GTEST_SKIP() << "needs the USB gadget " << kGadget
                   << ": run tests/vm/run.sh";
    }
  }

  // 24 triangles, one scan every `period_ms` milliseconds.
  void ReadAForearm(CanBus& bus, int period_ms, const char* name) {
    icub::IcubSkin skin(*icub::PortPatch(boards_), {.period_ms = period_ms});
    CanSkinDriver driver(&bus, &skin, {});
    const auto cost = MeasureDriver(driver, scans_, 1'000);
    ASSERT_TRUE(cost.ok()) << cost.status();
    std::printf("24 triangles at %d Hz over %s: %s\n", 1'000 / period_ms, name,
                cost->Text().c_str());
    EXPECT_EQ(cost->missing, 0u);
    EXPECT_EQ(cost->incomplete, 0u);
    EXPECT_EQ(cost->overwritten, 0u);
    EXPECT_EQ(bus.counters().overruns, 0u);
    EXPECT_EQ(bus.counters().malformed, 0u);
    // All frames have the number of their scan.
    EXPECT_GE(cost->scan_ages_ms.size(), 990u);
  }

  const std::vector<icub::SkinBoard> boards_ = *icub::ParseBoards("forearm-v2");
  NumberedScans scans_;
};

class KernelUsbRateTest : public KernelUsbTest,
                          public ::testing::WithParamInterface<int> {};

// The kernel's driver has the adapter first: it is detached, and gets it back.
TEST_P(KernelUsbRateTest, OurDriverLosesNothing) {
  const PlayedAdapter adapter(boards_, scans_.Source());
  ASSERT_NE(GsUsbInterface(), "");
  GsUsb bus({});
  ReadAForearm(bus, GetParam(), "libusb");
  EXPECT_NE(GsUsbInterface(), "");
}

TEST_P(KernelUsbRateTest, TheKernelsDriverLosesNothing) {
  const PlayedAdapter adapter(boards_, scans_.Source());
  const std::string interface = GsUsbInterface();
  ASSERT_NE(interface, "");
  const std::string up =
      "ip link set " + interface + " up type can bitrate 1000000";
  ASSERT_EQ(std::system(up.c_str()), 0);
  SocketCan bus(interface);
  ReadAForearm(bus, GetParam(), "the kernel's gs_usb");
}

INSTANTIATE_TEST_SUITE_P(Periods, KernelUsbRateTest, ::testing::Values(20, 10),
                         [](const auto& info) {
                           return std::to_string(info.param) + "ms";
                         });

// The device leaves the kernel's USB stack and comes back, without power
// meanwhile: the boards have lost their configuration.
TEST_F(KernelUsbTest, AnUnpluggedAdapterComesBack) {
  auto adapter = std::make_unique<PlayedAdapter>(boards_, scans_.Source());
  ASSERT_NE(GsUsbInterface(), "");
  GsUsb bus({});
  icub::IcubSkin skin(*icub::PortPatch(boards_), {});
  CanSkinDriver driver(&bus, &skin, {});
  BufferedDriver buffered(&driver, {});
  const auto info = buffered.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  ASSERT_TRUE(buffered.Activate().ok());
  SkinFrame frame;
  const auto read = [&](int frames) {
    uint64_t missing = 0;
    while (frames > 0) {
      const auto result = buffered.Read(frame);
      EXPECT_TRUE(result.ok()) << result.status();
      if (!result.ok()) return missing;
      if (*result != ReadResult::kFrame) continue;
      missing += frame.missing_before;
      --frames;
    }
    return missing;
  };
  EXPECT_EQ(read(50), 0u);
  adapter.reset();
  while (buffered.Statistics().connected) {
    ASSERT_TRUE(buffered.Read(frame).ok());
  }
  // "unplugged", or that transfers fail, which comes before the hub's report.
  EXPECT_THAT(buffered.Statistics().problem, HasSubstr("gs_usb: "));
  adapter = std::make_unique<PlayedAdapter>(boards_, scans_.Source());
  EXPECT_GT(read(50), 0u);
  EXPECT_TRUE(buffered.Finalise().ok());
  EXPECT_EQ(driver.Statistics().reconnects, 1u);
}

TEST_F(KernelUsbTest, AnAdapterThatIsResetGoesOn) {
  const PlayedAdapter adapter(boards_, scans_.Source());
  for (int i = 0; i < 20; ++i) {
    ASSERT_NE(GsUsbInterface(), "") << i;
    OpenedAdapter opened;
    ASSERT_TRUE(i % 2 == 0 ? opened.ResetInterface() : opened.ResetDevice())
        << i;
  }
  GsUsb bus({});
  ReadAForearm(bus, 20, "libusb after 20 resets");
}

}  // namespace
}  // namespace tactus::internal::client
