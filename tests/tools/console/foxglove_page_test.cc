// What a program that speaks the protocol of Foxglove hears, without a socket.
#include "tools/console/foxglove_page.h"

#include <cstring>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "core/base/limits_console.h"
#include "core/base/limits_monitor.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "tests/tools/console/robot_fixture.h"
#include "tools/console/foxglove_protocol.h"

namespace tactus::internal::console {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const RobotNews::Time kStart = RobotNews::Time() + std::chrono::hours(1);
constexpr int64_t kUnixNs = 1'700'000'000'000'000'000;

// One server, and a viewer.
struct Viewing {
  RobotNews news;
  RobotNews::Cursor cursor;
  FoxglovePage page{"session"};

  void Add(const v1::StreamUpdate& update) { news.Add(update, kStart); }

  // The next message; null if there is none. A binary one is an object with
  // "subscription", "time" and "payload".
  json Next() {
    const auto message =
        page.Next({{.address = "lab", .news = news.Read(cursor)}},
                  {kStart + milliseconds(3), kUnixNs});
    if (!message) return nullptr;
    if (message->is_text) return json::parse(message->bytes);
    McapCursor bytes(message->bytes);
    EXPECT_EQ(bytes.Number<uint8_t>(), 1);
    json data = {{"subscription", bytes.Number<uint32_t>()},
                 {"time", bytes.Number<uint64_t>()}};
    data["payload"] = std::string(bytes.rest());
    return data;
  }
  std::vector<json> All() {
    std::vector<json> all;
    for (json next = Next(); !next.is_null(); next = Next()) {
      all.push_back(std::move(next));
    }
    return all;
  }
  // The channel of a topic among those that are offered; 0 if there is none.
  static uint32_t ChannelOf(const std::vector<json>& all,
                            const std::string& topic) {
    for (const json& message : all) {
      if (message.value("op", "") != "advertise") continue;
      for (const json& channel : message["channels"]) {
        if (channel["topic"] == topic) return channel["id"];
      }
    }
    return 0;
  }
  std::string Say(const std::string& text) {
    return page.Hear({.bytes = text, .is_text = true});
  }
  void Subscribe(uint32_t subscription, uint32_t channel) {
    const json message = {
        {"op", "subscribe"},
        {"subscriptions", {{{"id", subscription}, {"channelId", channel}}}}};
    EXPECT_EQ(Say(message.dump()), "");
  }
};

uint64_t AnswerNumber(const json& data) {
  v1::Answer answer;
  EXPECT_TRUE(answer.ParseFromString(data["payload"].get<std::string>()));
  return answer.sequence();
}

uint64_t EventNumber(const json& data) {
  v1::WatchedEvent event;
  EXPECT_TRUE(event.ParseFromString(data["payload"].get<std::string>()));
  return event.sequence();
}

TEST(FoxglovePageTest, IntroducesItselfThenOffersChannels) {
  Viewing viewer;
  std::vector<json> all = viewer.All();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0]["op"], "serverInfo");
  EXPECT_THAT(all[0]["name"].get<std::string>(), HasSubstr("tactus-console"));
  EXPECT_EQ(all[0]["capabilities"], json::array());
  EXPECT_EQ(all[0]["sessionId"], "session");
  EXPECT_EQ(all[1], (json{{"op", "advertise"}, {"channels", json::array()}}));

  viewer.Add(OpenedRobot("7", "arm"));
  all = viewer.All();
  ASSERT_EQ(all.size(), 1u);
  std::vector<std::string> names;
  for (const json& channel : all[0]["channels"]) {
    names.push_back(channel["topic"].get<std::string>() + " " +
                    channel["schemaName"].get<std::string>());
    EXPECT_EQ(channel["encoding"], "protobuf");
    EXPECT_EQ(channel["schemaEncoding"], "protobuf");
    std::string schema;
    EXPECT_TRUE(
        absl::Base64Unescape(channel["schema"].get<std::string>(), &schema));
    EXPECT_FALSE(schema.empty());
  }
  EXPECT_THAT(names, ElementsAre("/arm/skin foxglove.RawImage",
                                 "/arm/answer tactus.v1.Answer",
                                 "/arm/contacts foxglove.ImageAnnotations",
                                 "/arm/events tactus.v1.WatchedEvent"));
  // Nobody has subscribed.
  viewer.Add(FrameOf("7", 1));
  viewer.Add(EventOf("7", 1));
  EXPECT_THAT(viewer.All(), IsEmpty());
}

TEST(FoxglovePageTest, ASlowViewerGetsTheNewestFrameOfEachChannel) {
  Viewing viewer;
  viewer.Add(OpenedRobot("7", "arm"));
  const std::vector<json> offers = viewer.All();
  viewer.Add(FrameOf("7", 1));
  viewer.Subscribe(4, viewer.ChannelOf(offers, "/arm/answer"));
  // What came before the subscription.
  json data = viewer.Next();
  EXPECT_EQ(AnswerNumber(data), 1u);
  EXPECT_EQ(data["subscription"], 4);
  // When the frame came, by the console's clock.
  EXPECT_EQ(data["time"], kUnixNs - 3'000'000);
  EXPECT_TRUE(viewer.Next().is_null());

  for (uint64_t s = 2; s <= 6; ++s) viewer.Add(FrameOf("7", s));
  EXPECT_EQ(AnswerNumber(viewer.Next()), 6u);
  EXPECT_TRUE(viewer.Next().is_null());

  // Two channels take turns, and a frame that comes in between is taken.
  viewer.Subscribe(5, viewer.ChannelOf(offers, "/arm/skin"));
  EXPECT_EQ(viewer.Next()["subscription"], 5);
  viewer.Add(FrameOf("7", 7));
  EXPECT_EQ(viewer.Next()["subscription"], 5);
  for (uint64_t s = 8; s <= 9; ++s) viewer.Add(FrameOf("7", s));
  data = viewer.Next();
  EXPECT_EQ(data["subscription"], 4);
  EXPECT_EQ(AnswerNumber(data), 9u);
  EXPECT_EQ(viewer.Next()["subscription"], 5);
  EXPECT_TRUE(viewer.Next().is_null());
}

TEST(FoxglovePageTest, CountsTheEventsThatASlowViewerMisses) {
  Viewing viewer;
  viewer.Add(OpenedRobot("7", "arm"));
  viewer.Add(EventOf("7", 1'000));
  const std::vector<json> offers = viewer.All();
  viewer.Subscribe(1, viewer.ChannelOf(offers, "/arm/events"));
  // Events from the subscription on.
  EXPECT_THAT(viewer.All(), IsEmpty());
  constexpr uint64_t kMost = limits::kMaxWatchedEvents;
  for (uint64_t s = 1; s <= kMost + 10; ++s) viewer.Add(EventOf("7", s));
  json remark = viewer.Next();
  EXPECT_EQ(remark["op"], "status");
  EXPECT_EQ(remark["level"], 1);
  EXPECT_THAT(remark["message"].get<std::string>(),
              HasSubstr("10 events of /arm were left out"));
  EXPECT_EQ(EventNumber(viewer.Next()), 11u);
  // More come while it reads; the console keeps no more of them than before.
  for (uint64_t s = 1; s <= 5; ++s) viewer.Add(EventOf("7", 500 + s));
  const json next = viewer.Next();
  EXPECT_EQ(next["op"], "status");
  EXPECT_EQ(next["id"], remark["id"]);
  EXPECT_THAT(next["message"].get<std::string>(), HasSubstr("14 events"));
  const std::vector<json> rest = viewer.All();
  ASSERT_EQ(rest.size(), kMost);
  EXPECT_EQ(EventNumber(rest.front()), 16u);
  EXPECT_EQ(EventNumber(rest.back()), 505u);
}

TEST(FoxglovePageTest, WhatIsNotOfTheProtocolEndsTheConnection) {
  Viewing viewer;
  for (const char* text :
       {"", "{", "[]", "null", "\"subscribe\"", "{}", "{\"op\":7}",
        "{\"op\":\"subscribe\"}", "{\"op\":\"subscribe\",\"subscriptions\":{}}",
        "{\"op\":\"subscribe\",\"subscriptions\":[1]}",
        "{\"op\":\"subscribe\",\"subscriptions\":[{\"id\":1}]}",
        "{\"op\":\"subscribe\",\"subscriptions\":[{\"id\":1,\"channelId\":-1}]"
        "}",
        "{\"op\":\"subscribe\",\"subscriptions\":[{\"id\":1.5,"
        "\"channelId\":1}]}",
        "{\"op\":\"subscribe\",\"subscriptions\":[{\"id\":1,"
        "\"channelId\":4294967296}]}",
        "{\"op\":\"unsubscribe\"}",
        "{\"op\":\"unsubscribe\",\"subscriptionIds\":[\"1\"]}",
        "{\"op\":\"unsubscribe\",\"subscriptionIds\":1}"}) {
    EXPECT_NE(viewer.Say(text), "") << text;
    EXPECT_LE(viewer.Say(text).size(), 100u);
  }
  EXPECT_NE(viewer.Say(std::string(10'000, '[')), "");
}

TEST(FoxglovePageTest, WhatItCannotDoIsRemarkedUpon) {
  Viewing viewer;
  viewer.All();
  EXPECT_EQ(viewer.Say("{\"op\":\"getParameters\",\"parameterNames\":[]}"), "");
  EXPECT_EQ(viewer.page.Hear({.bytes = "\1\0\0\0\0x"}), "");
  const std::vector<json> remarks = viewer.All();
  ASSERT_EQ(remarks.size(), 2u);
  EXPECT_THAT(remarks[0]["message"].get<std::string>(),
              HasSubstr("\"getParameters\""));
  // One that reads nothing makes the console keep few of them.
  for (int i = 0; i < 1'000; ++i) {
    viewer.Say("{\"op\":\"" + std::string(10'000, 'x') + "\"}");
  }
  const std::vector<json> many = viewer.All();
  EXPECT_EQ(many.size(), limits::kMaxFoxgloveRemarks);
  for (const json& remark : many) EXPECT_LT(remark.dump().size(), 1'000u);
}

TEST(FoxglovePageTest, AChannelHasOneSubscription) {
  Viewing viewer;
  viewer.Add(OpenedRobot("7", "arm"));
  const std::vector<json> offers = viewer.All();
  const uint32_t answer = viewer.ChannelOf(offers, "/arm/answer");
  const uint32_t skin = viewer.ChannelOf(offers, "/arm/skin");
  viewer.Subscribe(1, answer);
  for (uint32_t id = 2; id < 10; ++id) viewer.Subscribe(id, answer);
  viewer.Subscribe(1, skin);
  viewer.Subscribe(2, 4'000'000'000);
  std::vector<json> all = viewer.All();
  EXPECT_EQ(all.size(), 10u);
  for (const json& remark : all) EXPECT_EQ(remark["op"], "status");
  viewer.Add(FrameOf("7", 1));
  all = viewer.All();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0]["subscription"], 1);

  // Numbers of which nobody knows are no mistake.
  EXPECT_EQ(viewer.Say("{\"op\":\"unsubscribe\",\"subscriptionIds\":[1,1,77]}"),
            "");
  viewer.Add(FrameOf("7", 2));
  EXPECT_THAT(viewer.All(), IsEmpty());
  viewer.Subscribe(1, skin);
  EXPECT_EQ(viewer.All().size(), 1u);
}

TEST(FoxglovePageTest, ChannelsGoWithTheirRobotAfterItsLastEvents) {
  Viewing viewer;
  viewer.Add(OpenedRobot("7", "arm"));
  const std::vector<json> offers = viewer.All();
  viewer.Subscribe(1, viewer.ChannelOf(offers, "/arm/events"));
  viewer.Subscribe(2, viewer.ChannelOf(offers, "/arm/answer"));
  viewer.Add(FrameOf("7", 1));
  viewer.Add(EventOf("7", 1));
  viewer.Add(EndOf("7"));
  // The same robot comes again.
  viewer.Add(OpenedRobot("8", "arm"));
  const std::vector<json> all = viewer.All();
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(EventNumber(all[0]), 1u);
  EXPECT_EQ(all[1],
            (json{{"op", "unadvertise"}, {"channelIds", {1, 2, 3, 4}}}));
  // A number is never used twice.
  EXPECT_EQ(viewer.ChannelOf(all, "/arm/skin"), 5u);
  // The viewer may not have heard.
  EXPECT_EQ(viewer.Say("{\"op\":\"unsubscribe\",\"subscriptionIds\":[1,2]}"),
            "");
  viewer.Subscribe(1, 6);
  viewer.Add(FrameOf("8", 3));
  EXPECT_EQ(AnswerNumber(viewer.Next()), 3u);
}

TEST(FoxglovePageTest, ASubscriptionThatCrossesAWithdrawalIsNoMistake) {
  Viewing viewer;
  viewer.Add(OpenedRobot("7", "arm"));
  EXPECT_EQ(viewer.ChannelOf(viewer.All(), "/arm/skin"), 1u);
  viewer.Add(EndOf("7"));
  ASSERT_EQ(viewer.All().size(), 1u);
  for (uint32_t channel = 1; channel <= 4; ++channel) {
    viewer.Subscribe(channel, channel);
  }
  EXPECT_TRUE(viewer.Next().is_null());

  // Numbers that were never offered are mistakes: 0, and the next one.
  for (const uint32_t channel : {0, 5}) {
    viewer.Subscribe(9, channel);
    EXPECT_THAT(viewer.Next()["message"].get<std::string>(),
                HasSubstr(absl::StrCat("there is no channel ", channel)));
  }
  // What was ignored holds no number of a subscription.
  viewer.Add(OpenedRobot("8", "arm"));
  const uint32_t answer = viewer.ChannelOf(viewer.All(), "/arm/answer");
  viewer.Subscribe(1, answer);
  viewer.Add(FrameOf("8", 3));
  EXPECT_EQ(AnswerNumber(viewer.Next()), 3u);
}

TEST(FoxglovePageTest, RobotsOfOneNameHaveTopicsOfTheirStreams) {
  Viewing viewer;
  viewer.Add(OpenedRobot("1", "left arm"));
  viewer.Add(OpenedRobot("2", "left arm"));
  viewer.Add(OpenedRobot("3", "left#arm"));
  viewer.Add(OpenedRobot("4", ""));
  viewer.Add(OpenedRobot("5", "4"));
  std::vector<std::string> topics;
  for (const json& message : viewer.All()) {
    if (message["op"] != "advertise") continue;
    topics.push_back(message["channels"][0]["topic"]);
  }
  EXPECT_THAT(topics, ElementsAre("/left_arm/skin", "/2/skin", "/3/skin",
                                  "/4/skin", "/5/skin"));
}

TEST(FoxglovePageTest, AfterALostConnectionRobotsAreOfferedAnew) {
  Viewing viewer;
  viewer.Add(OpenedRobot("7", "arm"));
  viewer.Subscribe(1, viewer.ChannelOf(viewer.All(), "/arm/answer"));
  viewer.news.Clear();
  std::vector<json> all = viewer.All();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0]["op"], "unadvertise");
  viewer.Add(OpenedRobot("7", "arm"));
  viewer.Add(FrameOf("7", 1));
  all = viewer.All();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(viewer.ChannelOf(all, "/arm/answer"), 6u);
}

TEST(FoxglovePageTest, OffersNoMoreRobotsThanItMay) {
  Viewing viewer;
  constexpr size_t kMost = limits::kMaxFoxgloveRobots;
  for (size_t i = 0; i < kMost + 2; ++i) {
    viewer.Add(OpenedRobot(std::to_string(100 + i), std::to_string(i)));
  }
  const std::vector<json> all = viewer.All();
  // The greeting, the offers, and one remark.
  ASSERT_EQ(all.size(), kMost + 2);
  EXPECT_EQ(all.back()["op"], "status");
  viewer.Add(EndOf("100"));
  const std::vector<json> next = viewer.All();
  ASSERT_EQ(next.size(), 2u);
  EXPECT_NE(viewer.ChannelOf(next, "/" + std::to_string(kMost) + "/skin"), 0u);
}

TEST(FoxgloveProtocolTest, TakesTheNewerOfThoseOffered) {
  EXPECT_EQ(FoxgloveProtocolOf("foxglove.websocket.v1"),
            "foxglove.websocket.v1");
  EXPECT_EQ(FoxgloveProtocolOf("foxglove.websocket.v1 , foxglove.sdk.v1"),
            "foxglove.sdk.v1");
  for (const char* none : {"", ",", "foxglove.sdk.v2", "xfoxglove.sdk.v1"}) {
    EXPECT_EQ(FoxgloveProtocolOf(none), "") << none;
  }
}

}  // namespace
}  // namespace tactus::internal::console
