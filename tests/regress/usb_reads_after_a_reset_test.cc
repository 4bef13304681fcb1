// The simulated USB adapter heard nothing from its host any more once the host
// had reset it: reads whose failure was reported after the host had configured
// the device anew were not begun again.
#include <cstdint>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/tools/fakeskin/played_function_fs.h"
#include "tools/fakeskin/function_fs.h"

namespace tactus::internal::client {
namespace {

using ::testing::ElementsAre;

TEST(UsbReadsAfterAResetTest, BeginAgainIfTheyFail) {
  PlayedFunctionFs kernel;
  std::vector<std::vector<uint8_t>> received;
  FunctionFs function(kernel.options(),
                      {.write = [](uint8_t, std::span<const uint8_t>) {},
                       .read = [](uint8_t) { return std::nullopt; },
                       .received =
                           [&](std::span<const uint8_t> data) {
                             received.emplace_back(data.begin(), data.end());
                           }});
  ASSERT_TRUE(function.Open().ok());
  kernel.Opened();
  // The host resets and configures the device. All reads fail, and their
  // failures come after that event.
  kernel.Report(FUNCTIONFS_ENABLE);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(function.Wait(0).ok());
  for (uint8_t i = 0; i < 3; ++i) {
    kernel.SendBulk(std::vector<uint8_t>{i, 2, 3});
    for (int k = 0; k < 10; ++k) ASSERT_TRUE(function.Wait(0).ok());
  }
  EXPECT_THAT(received, ElementsAre(ElementsAre(0, 2, 3), ElementsAre(1, 2, 3),
                                    ElementsAre(2, 2, 3)));
}

}  // namespace
}  // namespace tactus::internal::client
