// What the driver of a forearm over USB costs, and how old its frames are: 24
// triangles at 50 Hz behind an adapter that umockdev plays. The time of the
// adapter, which is played in the same process, is not counted; the calls
// through umockdev's library are, which a real device does not have.
#include <cstdlib>

#include "client/drivers/buffered_driver.h"
#include "client/drivers/can/gs_usb.h"
#include "client/drivers/can_skin_driver.h"
#include "client/drivers/icub_skin/icub_skin.h"
#include "client/tools/common/percentile.h"
#include "client/tools/fakeskin/icub_boards.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/mock_adapter.h"
#include "tests/client/drivers/thread_cpu.h"

namespace tactus::client {
namespace {

TEST(UsbCostTest, AForearmOverUsb) {
  const char* preloaded = std::getenv("LD_PRELOAD");
  if (preloaded == nullptr ||
      std::string(preloaded).find("umockdev") == std::string::npos) {
    GTEST_SKIP() << "runs under umockdev-wrapper only";
  }
  constexpr int kFrames = 1'000;
  const auto boards = *icub::ParseBoards("forearm-v2");
  IcubBoards skin(boards, [](int64_t t, size_t, std::span<double> counts) {
    counts[0] = static_cast<double>(t / 20'000'000 % 100);
  });
  MockAdapter adapter(&skin, {});
  GsUsb bus({});
  icub::IcubSkin protocol(*icub::PortPatch(boards), {.period_ms = 20});
  CanSkinDriver driver(&bus, &protocol, {.give_up_ns = 0});
  ThreadCpu measured(&driver);
  BufferedDriver buffered(&measured, {});
  const auto info = buffered.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  ASSERT_TRUE(buffered.Activate().ok());
  Clock& clock = Clock::System();
  SkinFrame frame;
  std::vector<double> ages_ms;
  uint64_t missing = 0;
  double cpu_s = 0;
  double system_s = 0;
  int64_t begin_ns = 0;
  for (int frames = 0; frames < kFrames;) {
    const auto result = buffered.Read(frame);
    ASSERT_TRUE(result.ok()) << result.status();
    if (*result != ReadResult::kFrame) continue;
    const int64_t now_ns = clock.NowNs();
    // The first frames meet cold caches.
    if (++frames == 50) {
      begin_ns = now_ns;
      cpu_s = measured.seconds();
      system_s = measured.system_seconds();
    }
    missing += frame.missing_before;
    ages_ms.push_back(static_cast<double>(now_ns - frame.capture_time_ns) /
                      1e6);
  }
  cpu_s = measured.seconds() - cpu_s;
  system_s = measured.system_seconds() - system_s;
  const double wall_s = static_cast<double>(clock.NowNs() - begin_ns) / 1e9;
  std::printf(
      "24 triangles at 50 Hz over USB: %d frames, missing %llu; driver %.1f %% "
      "of a core, %.1f %% of it in the kernel; age p50 %.2f, p99 %.2f, largest "
      "%.2f ms\n",
      kFrames, static_cast<unsigned long long>(missing), 100 * cpu_s / wall_s,
      100 * system_s / cpu_s, Percentile(ages_ms, 0.5),
      Percentile(ages_ms, 0.99), Percentile(ages_ms, 1));
  EXPECT_EQ(missing, 0u);
  EXPECT_GT(cpu_s, 0);
  EXPECT_TRUE(buffered.Finalise().ok());
}

}  // namespace
}  // namespace tactus::client
