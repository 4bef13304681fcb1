// The whole path over USB, in real time: simulated contacts, boards behind an
// adapter that umockdev plays, libusb, the iCub's driver in its thread, and a
// real tactusd.
#include <cstdlib>
#include <mutex>

#include "client/drivers/buffered_driver.h"
#include "client/drivers/can/gs_usb.h"
#include "client/drivers/can_skin_driver.h"
#include "client/drivers/icub_skin/icub_skin.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/can/mock_adapter.h"
#include "tests/support/child_tactusd.h"
#include "tools/fakeskin/sim_touches.h"
#include "tools/stream/live_player.h"

namespace tactus::internal::client {
namespace {

TEST(UsbStreamTest, ContactsAreClassifiedOverUsb) {
  const char* preloaded = std::getenv("LD_PRELOAD");
  if (preloaded == nullptr ||
      std::string(preloaded).find("umockdev") == std::string::npos) {
    GTEST_SKIP() << "runs under umockdev-wrapper only";
  }
  testing::ChildTactusd server;
  ASSERT_NE(server.port(), 0);
  // Eight triangles, rows 4 to 7 of the skin, and contacts on them: the adapter
  // is played too slowly for 32 triangles at 100 Hz.
  SimTouches touches({.seed = 5,
                      .contacts = 4,
                      .centre = SkinPoint{.row = 5.5, .column = 11},
                      .newton_per_count = 0.01});
  touches.MakeAll();
  touches.BeginAt(Clock::System().NowNs() + 3'000'000'000);
  // The adapter's thread and the driver's ask for contacts.
  std::mutex mutex;
  const std::vector<icub::SkinBoard> board = {
      {.address = 1, .triangles = 0xFF00}};
  const auto source = touches.Source();
  IcubBoards boards(board, [&](int64_t t, size_t j, std::span<double> counts) {
    const std::lock_guard lock(mutex);
    source(t, j, counts);
  });
  MockAdapter adapter(&boards, {});
  GsUsb bus({});
  icub::SkinPatch patch = touches.patch();
  patch.boards = board;
  patch.cells.resize(icub::kBoardValues);
  icub::IcubSkin skin(patch, {.period_ms = 10, .scale = 0.01});
  CanSkinDriver driver(&bus, &skin,
                       {.pose_at = [&](int64_t t) -> std::optional<Pose> {
                         const std::lock_guard lock(mutex);
                         return touches.PoseAt(t);
                       }});
  BufferedDriver buffered(&driver, {});
  int right = 0;
  int contacts = 0;
  LivePlayer* self = nullptr;
  LivePlayer player(
      MakeChannel(server.address()), &buffered, {.seconds = 120},
      [&](const LiveContact& contact) {
        const std::lock_guard lock(mutex);
        right += self->class_names()[contact.answer] ==
                 touches.LabelAt(contact.onset_ns);
        if (++contacts == 4) self->Stop();
      },
      [](const std::string&) {});
  self = &player;
  const absl::Status status = player.Run();
  ASSERT_TRUE(status.ok()) << status;
  const DriverStatistics& s = player.statistics();
  std::printf(
      "%d of %d contacts right over USB; %llu frames, lost %llu, "
      "overwritten %llu, age at most %.1f ms\n",
      right, contacts, static_cast<unsigned long long>(s.frames),
      static_cast<unsigned long long>(s.lost),
      static_cast<unsigned long long>(s.overwritten), s.longest_age_ms);
  EXPECT_EQ(contacts, 4);
  EXPECT_EQ(right, 4);
  EXPECT_EQ(s.lost, 0u);
  EXPECT_FALSE(adapter.started());
}

}  // namespace
}  // namespace tactus::internal::client
