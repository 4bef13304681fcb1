#include "tools/console/robot_news.h"

#include <cstring>

#include "core/base/limits_monitor.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "tools/console/live_message.h"

namespace tactus::internal::console {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;

const RobotNews::Time kNow = RobotNews::Time() + std::chrono::hours(1);

v1::StreamUpdate Opened(const std::string& id) {
  v1::StreamUpdate update;
  update.set_stream_id(id);
  update.mutable_opened()->set_stream_id(id);
  update.mutable_opened()->set_client_id("arm-" + id);
  return update;
}

v1::StreamUpdate Frame(const std::string& id, uint64_t sequence,
                       const std::vector<float>& taxels) {
  v1::StreamUpdate update;
  update.set_stream_id(id);
  update.mutable_counts()->set_frames(sequence);
  update.mutable_frame()->mutable_answer()->set_sequence(sequence);
  update.mutable_frame()->set_taxels(taxels.data(),
                                     taxels.size() * sizeof(float));
  return update;
}

// What a page gets, parsed.
struct Page {
  RobotNews::Cursor cursor;
  json message;
  std::string taxels;

  json Read(const RobotNews& news, RobotNews::Time now = kNow) {
    const std::string bytes =
        LiveMessage({{.address = "lab", .news = news.Read(cursor)}}, now);
    uint32_t length = 0;
    std::memcpy(&length, bytes.data(), sizeof length);
    message = json::parse(bytes.substr(sizeof length, length));
    taxels = bytes.substr(sizeof length + length);
    return message["updates"];
  }
  float Taxel(size_t i) const {
    float value = 0;
    std::memcpy(&value, taxels.data() + i * sizeof(float), sizeof(float));
    return value;
  }
};

TEST(RobotNewsTest, DescribesFirstThenOnlyWhatIsNew) {
  RobotNews news;
  Page page;
  EXPECT_FALSE(news.HasNews(page.cursor));
  news.Add(Opened("1"), kNow);
  EXPECT_TRUE(news.HasNews(page.cursor));
  json updates = page.Read(news);
  ASSERT_EQ(updates.size(), 1u);
  EXPECT_EQ(updates[0]["update"]["opened"]["client_id"], "arm-1");
  EXPECT_EQ(updates[0]["taxels"], -1);
  EXPECT_FALSE(news.HasNews(page.cursor));
  EXPECT_TRUE(page.Read(news).empty());

  news.Add(Frame("1", 7, {1, 2.5}), kNow);
  EXPECT_TRUE(news.HasNews(page.cursor));
  updates = page.Read(news);
  ASSERT_EQ(updates.size(), 1u);
  const json& update = updates[0]["update"];
  EXPECT_FALSE(update.contains("opened"));
  EXPECT_EQ(update["frame"]["answer"]["sequence"], "7");
  EXPECT_EQ(update["frame"]["taxels"], "");
  EXPECT_EQ(updates[0]["taxels"], 0);
  EXPECT_EQ(page.Taxel(1), 2.5F);
}

TEST(RobotNewsTest, ASlowPageGetsTheNewestFrameAndAllEvents) {
  RobotNews news;
  Page page;
  news.Add(Opened("1"), kNow);
  news.Add(Opened("2"), kNow);
  page.Read(news);
  for (uint64_t s = 1; s <= 5; ++s) {
    v1::StreamUpdate update = Frame("1", s, {static_cast<float>(s)});
    update.add_events()->set_sequence(s);
    news.Add(update, kNow + milliseconds(s));
  }
  news.Add(Frame("2", 9, {9}), kNow);
  const json updates = page.Read(news, kNow + milliseconds(50));
  ASSERT_EQ(updates.size(), 2u);
  EXPECT_EQ(updates[0]["update"]["frame"]["answer"]["sequence"], "5");
  EXPECT_EQ(updates[0]["update"]["events"].size(), 5u);
  EXPECT_EQ(updates[0]["update"]["events_left_out"], 0);
  EXPECT_EQ(page.Taxel(updates[0]["taxels"]), 5);
  EXPECT_EQ(page.Taxel(updates[1]["taxels"]), 9);
  EXPECT_EQ(page.message["waited_us"], 50'000);
}

TEST(RobotNewsTest, SaysHowManyEventsAreLeftOut) {
  RobotNews news;
  Page page;
  news.Add(Opened("1"), kNow);
  page.Read(news);
  for (uint64_t s = 1; s <= limits::kMaxWatchedEvents + 10; ++s) {
    v1::StreamUpdate update = Frame("1", s, {});
    update.add_events()->set_sequence(s);
    news.Add(update, kNow);
  }
  const json updates = page.Read(news);
  EXPECT_EQ(updates[0]["update"]["events_left_out"], 10);
  EXPECT_EQ(updates[0]["update"]["events"].size(), limits::kMaxWatchedEvents);
  EXPECT_EQ(updates[0]["update"]["events"][0]["sequence"], "11");
  // A page that comes now has missed none.
  Page late;
  EXPECT_EQ(late.Read(news)[0]["update"]["events_left_out"], 0);
}

TEST(RobotNewsTest, AfterALossAllIsNew) {
  RobotNews news;
  Page page;
  news.Add(Opened("1"), kNow);
  page.Read(news);
  news.Clear();
  EXPECT_FALSE(news.HasNews(page.cursor));
  v1::StreamUpdate other = Opened("1");
  other.mutable_opened()->set_client_id("another");
  news.Add(other, kNow);
  EXPECT_TRUE(news.HasNews(page.cursor));
  const json updates = page.Read(news);
  EXPECT_EQ(updates[0]["update"]["opened"]["client_id"], "another");
}

TEST(RobotNewsTest, StreamsThatEndedAreForgottenInTime) {
  RobotNews news;
  for (int i = 0; i < 1'000; ++i) {
    v1::StreamUpdate update = Opened(std::to_string(i));
    update.set_ended(true);
    news.Add(update, kNow);
  }
  Page page;
  EXPECT_EQ(page.Read(news).size(), 64u);
}

TEST(RobotNewsTest, ThoseWhoLookSeldomHearOfTheEndOfAForgottenRobot) {
  RobotNews news;
  Page page;
  news.Add(Opened("first"), kNow);
  page.Read(news);
  v1::StreamUpdate end;
  end.set_stream_id("first");
  end.set_ended(true);
  news.Add(end, kNow);
  for (int i = 0; i < 100; ++i) {
    v1::StreamUpdate update = Opened(std::to_string(i));
    update.set_ended(true);
    news.Add(update, kNow);
  }
  const json updates = page.Read(news);
  EXPECT_EQ(updates[0]["update"]["stream_id"], "first");
  EXPECT_EQ(updates[0]["update"]["ended"], true);
  EXPECT_TRUE(page.Read(news).empty());
}

TEST(RobotNewsTest, WatchersShareFramesAndEvents) {
  RobotNews news;
  news.Add(Opened("1"), kNow);
  v1::StreamUpdate update = Frame("1", 7, {1, 2.5});
  update.add_events()->set_sequence(7);
  news.Add(update, kNow);
  RobotNews::Cursor one;
  RobotNews::Cursor other;
  const RobotUpdate mine = news.Read(one).robots[0];
  const RobotUpdate theirs = news.Read(other).robots[0];
  EXPECT_EQ(mine.frame, theirs.frame);
  EXPECT_EQ(mine.events, theirs.events);
  EXPECT_EQ(mine.frame->message.taxels(), update.frame().taxels());
  EXPECT_EQ(mine.events[0]->message.sequence(), 7u);
  // What somebody holds stays as it is.
  news.Add(Frame("1", 8, {3, 4}), kNow);
  EXPECT_EQ(mine.frame->message.answer().sequence(), 7u);
}

TEST(RobotNewsTest, TextOfRobotsStaysText) {
  RobotNews news;
  Page page;
  v1::StreamUpdate update = Opened("1\",\"x\":\"</script>");
  update.mutable_opened()->set_client_id("\"><img src=x>\n\xc3\xa9");
  news.Add(update, kNow);
  const json updates = page.Read(news);
  EXPECT_EQ(updates[0]["update"]["stream_id"], "1\",\"x\":\"</script>");
  EXPECT_EQ(updates[0]["update"]["opened"]["client_id"],
            "\"><img src=x>\n\xc3\xa9");
}

}  // namespace
}  // namespace tactus::internal::console
