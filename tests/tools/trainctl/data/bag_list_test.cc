#include "tools/trainctl/data/bag_list.h"

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"

namespace tactus::internal::client {
namespace {

const std::string kTouchBag = std::string(TACTUS_GOLDEN) + "/bags/touch.mcap";

TEST(BagListTest, JsonHasWhatScriptsAskFor) {
  ::testing::internal::CaptureStdout();
  const absl::Status status = ListBag(kTouchBag, /*json=*/true);
  const auto json =
      nlohmann::json::parse(::testing::internal::GetCapturedStdout());
  ASSERT_TRUE(status.ok()) << status;
  EXPECT_EQ(json.at("storage"), "mcap");
  EXPECT_EQ(json.at("messages"), 120);
  EXPECT_EQ(json.at("cut_off").size(), 0U);
  ASSERT_EQ(json.at("topics").size(), 4U);
  const nlohmann::json& topic = json.at("topics").at(0);
  EXPECT_EQ(topic.at("name"), "/touch/array");
  EXPECT_EQ(topic.at("type"), "std_msgs/msg/Float32MultiArray");
  EXPECT_EQ(topic.at("encoding"), "cdr");
  EXPECT_EQ(topic.at("messages"), 30);
  EXPECT_NEAR(topic.at("rate_hz").get<double>(), 50, 1e-9);
  EXPECT_EQ(topic.at("shape"), nlohmann::json({2, 2}));
  EXPECT_EQ(topic.at("unread"), nullptr);
  EXPECT_EQ(json.at("mapping").at("dataset"), "/touch/array");
}

TEST(BagListTest, TextHasAMapping) {
  ::testing::internal::CaptureStdout();
  const absl::Status status = ListBag(kTouchBag, /*json=*/false);
  const std::string text = ::testing::internal::GetCapturedStdout();
  ASSERT_TRUE(status.ok()) << status;
  EXPECT_THAT(text,
              ::testing::HasSubstr(
                  "/touch/image  sensor_msgs/msg/Image, cdr, 30 messages, 50 "
                  "Hz, taxels: 2 x 3 in data\n"));
  EXPECT_THAT(text, ::testing::HasSubstr("\"dataset\": \"/touch/array\""));
}

TEST(BagListTest, RefusesWhatIsNoBag) {
  EXPECT_EQ(ReasonOf(ListBag(__FILE__, true)), "TRIAL_FILE_INVALID");
  EXPECT_EQ(ReasonOf(ListBag("/absent", true)), "IO");
}

}  // namespace
}  // namespace tactus::internal::client
