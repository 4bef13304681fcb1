#include "tools/console/robot_news.h"

#include <algorithm>
#include <utility>

#include "core/base/limits_monitor.h"
#include "google/protobuf/util/json_util.h"

namespace tactus::internal::console {
namespace {

constexpr size_t kEndedRobots = 64;

std::string JsonOf(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  options.always_print_primitive_fields = true;
  std::string json;
  const auto status =
      google::protobuf::util::MessageToJsonString(message, &json, options);
  // Fails for text that is not UTF-8, which parsing has refused.
  return status.ok() ? json : "{}";
}

template <class Message>
SharedItem<Message> ItemOf(const Message& message) {
  return std::make_shared<const NewsItem<Message>>(
      NewsItem<Message>{message, JsonOf(message)});
}

SharedItem<v1::WatchedFrame> FrameItem(const v1::WatchedFrame& frame) {
  auto item = std::make_shared<NewsItem<v1::WatchedFrame>>();
  item->message = frame;
  std::string taxels = std::move(*item->message.mutable_taxels());
  item->message.clear_taxels();
  item->json = JsonOf(item->message);
  item->message.set_taxels(std::move(taxels));
  return item;
}

}  // namespace

void RobotNews::Add(const v1::StreamUpdate& update, Time now) {
  Robot& robot = robots_[update.stream_id()];
  robot.news = ++news_;
  if (update.has_opened()) robot.opened = ItemOf(update.opened());
  if (update.has_counts()) robot.counts = ItemOf(update.counts());
  if (update.has_frame()) {
    robot.frame = FrameItem(update.frame());
    robot.frame_time = now;
    ++robot.frames;
  }
  robot.event_count += update.events_left_out();
  for (const v1::WatchedEvent& event : update.events()) {
    ++robot.event_count;
    robot.events.push_back(ItemOf(event));
    if (robot.events.size() > limits::kMaxWatchedEvents) {
      robot.events.pop_front();
    }
  }
  if (update.ended() && !robot.ended) {
    robot.ended = true;
    ended_.push_back(update.stream_id());
    ForgetEnded();
  }
}

void RobotNews::ForgetEnded() {
  while (ended_.size() > kEndedRobots) {
    robots_.erase(ended_.front());
    ended_.pop_front();
  }
}

void RobotNews::Clear() {
  robots_.clear();
  ended_.clear();
  ++connection_;
}

bool RobotNews::HasNews(const Cursor& cursor) const {
  if (cursor.connection != connection_) return !robots_.empty();
  return std::ranges::any_of(robots_, [&](const auto& item) {
    const auto seen = cursor.streams.find(item.first);
    return seen == cursor.streams.end() ||
           seen->second.news != item.second.news;
  });
}

RobotNews::News RobotNews::Read(Cursor& cursor) const {
  News news;
  if (cursor.connection != connection_) {
    news.anew = true;
    cursor.connection = connection_;
    cursor.streams.clear();
  }
  // Robots that are forgotten have ended, also for those who look seldom.
  std::erase_if(cursor.streams, [&](const auto& item) {
    if (robots_.contains(item.first)) return false;
    if (!item.second.ended) {
      news.robots.push_back({.stream_id = item.first, .ended = true});
    }
    return true;
  });
  for (const auto& [id, robot] : robots_) {
    Seen& seen = cursor.streams[id];
    if (seen.opened && seen.news == robot.news) continue;
    news.robots.push_back(UpdateOf(id, robot, seen));
  }
  return news;
}

RobotUpdate RobotNews::UpdateOf(const std::string& id, const Robot& robot,
                                Seen& seen) {
  RobotUpdate update = {
      .stream_id = id, .counts = robot.counts, .ended = robot.ended};
  if (!seen.opened) update.opened = robot.opened;
  if (robot.frames > seen.frame) {
    update.frame = robot.frame;
    update.frame_time = robot.frame_time;
  }
  const uint64_t kept = robot.event_count - robot.events.size();
  // A watcher that comes late has missed nothing; it sees those that are kept.
  if (!seen.opened) seen.events = kept;
  const uint64_t first = std::max(seen.events, kept);
  update.events_left_out = first - seen.events;
  update.events.assign(
      robot.events.begin() + static_cast<ptrdiff_t>(first - kept),
      robot.events.end());
  seen = {.opened = true,
          .news = robot.news,
          .frame = robot.frames,
          .events = robot.event_count,
          .ended = robot.ended};
  return update;
}

}  // namespace tactus::internal::console
