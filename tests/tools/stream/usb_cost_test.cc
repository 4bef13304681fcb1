// What the driver of a forearm over USB costs, and how old its frames are: 24
// triangles at 50 Hz behind an adapter that umockdev plays. The time of the
// adapter, which is played in the same process, is not counted; the calls
// through umockdev's library are, which a real device does not have.
#include <cstdlib>

#include "client/drivers/can/gs_usb.h"
#include "client/drivers/can_skin_driver.h"
#include "client/drivers/icub_skin/icub_skin.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/can/mock_adapter.h"
#include "tests/client/drivers/driver_cost.h"

namespace tactus::internal::client {
namespace {

TEST(UsbCostTest, AForearmOverUsb) {
  const char* preloaded = std::getenv("LD_PRELOAD");
  if (preloaded == nullptr ||
      std::string(preloaded).find("umockdev") == std::string::npos) {
    GTEST_SKIP() << "runs under umockdev-wrapper only";
  }
  const auto boards = *icub::ParseBoards("forearm-v2");
  NumberedScans scans;
  IcubBoards skin(boards, scans.Source());
  MockAdapter adapter(&skin, {});
  GsUsb bus({});
  icub::IcubSkin protocol(*icub::PortPatch(boards), {.period_ms = 20});
  CanSkinDriver driver(&bus, &protocol, {.give_up_ns = 0});
  const auto cost = MeasureDriver(driver, scans, 1'000);
  ASSERT_TRUE(cost.ok()) << cost.status();
  std::printf(
      "24 triangles at 50 Hz over umockdev: %s; %.1f %% of the driver's time "
      "in "
      "the kernel\n",
      cost->Text().c_str(), 100 * cost->system_s / cost->cpu_s);
  EXPECT_EQ(cost->missing, 0u);
  EXPECT_GT(cost->cpu_s, 0);
}

}  // namespace
}  // namespace tactus::internal::client
