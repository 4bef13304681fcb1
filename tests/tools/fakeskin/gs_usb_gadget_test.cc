#include "tools/fakeskin/gs_usb_gadget.h"

#include <vector>

#include "client/drivers/can/gs_usb_protocol.h"
#include "gtest/gtest.h"
#include "tests/tools/fakeskin/played_function_fs.h"

namespace tactus::internal::client {
namespace {

using gs_usb::Request;

uint8_t Code(Request request) { return static_cast<uint8_t>(request); }

TEST(GsUsbGadgetTest, FramesWhileItIsStoppedAreNotMalformed) {
  PlayedFunctionFs kernel;
  GsUsbGadget bus(kernel.options());
  ASSERT_TRUE(bus.Open({}).ok());
  kernel.Opened();
  kernel.Report(FUNCTIONFS_ENABLE);
  CanFrame frame;
  // Several times, because each takes one step.
  const auto receives = [&] {
    bool received = false;
    for (int i = 0; i < 10 && !received; ++i) received = *bus.Receive(frame, 0);
    return received;
  };
  EXPECT_FALSE(receives());
  const CanFrame sent = MakeCanFrame(0x201, {7, 0});
  const auto bytes = gs_usb::Bytes(gs_usb::ToHostFrame(sent, 3), false);
  kernel.SendBulk(bytes);
  EXPECT_FALSE(receives());
  EXPECT_EQ(bus.while_stopped(), 1u);
  kernel.SendControl(Code(Request::kBitTiming),
                     gs_usb::Bytes(gs_usb::BitTiming{1, 12, 2, 1, 3}));
  EXPECT_FALSE(receives());
  kernel.SendControl(Code(Request::kMode),
                     gs_usb::Bytes({gs_usb::kModeStart, 0}));
  EXPECT_FALSE(receives());
  kernel.SendBulk(bytes);
  ASSERT_TRUE(receives());
  EXPECT_TRUE(frame.SameAs(sent));
  kernel.SendBulk({bytes.data(), 5});
  EXPECT_FALSE(receives());
  EXPECT_EQ(bus.counters().malformed, 1u);
  EXPECT_EQ(bus.counters().received, 1u);
  EXPECT_EQ(bus.while_stopped(), 1u);
}

}  // namespace
}  // namespace tactus::internal::client
