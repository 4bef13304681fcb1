#include "tools/console/robot_news.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/limits_monitor.h"
#include "google/protobuf/util/json_util.h"
#include "tools/common/json.h"

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

}  // namespace

void RobotNews::Add(const v1::StreamUpdate& update, Time now) {
  Robot& robot = robots_[update.stream_id()];
  robot.news = ++news_;
  if (update.has_opened()) {
    robot.id = client::JsonText(update.stream_id());
    robot.opened = JsonOf(update.opened());
  }
  if (update.has_counts()) robot.counts = JsonOf(update.counts());
  if (update.has_frame()) {
    v1::WatchedFrame frame = update.frame();
    robot.taxels = std::move(*frame.mutable_taxels());
    frame.clear_taxels();
    robot.frame = JsonOf(frame);
    robot.frame_time = now;
    ++robot.frames;
  }
  robot.event_count += update.events_left_out();
  for (const v1::WatchedEvent& event : update.events()) {
    ++robot.event_count;
    robot.events.push_back(JsonOf(event));
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

void RobotNews::Write(Cursor& cursor, int server, Time now,
                      Message& message) const {
  if (cursor.connection != connection_) {
    cursor.connection = connection_;
    cursor.streams.clear();
  }
  std::erase_if(cursor.streams, [&](const auto& item) {
    return !robots_.contains(item.first);
  });
  for (const auto& [id, robot] : robots_) {
    Seen& seen = cursor.streams[id];
    if (seen.opened && seen.news == robot.news) continue;
    WriteRobot(robot, server, now, seen, message);
  }
}

void RobotNews::WriteRobot(const Robot& robot, int server, Time now, Seen& seen,
                           Message& message) {
  const bool has_frame = robot.frames > seen.frame;
  int64_t taxels = -1;
  if (has_frame && !robot.taxels.empty()) {
    taxels = static_cast<int64_t>(message.taxels.size() / sizeof(float));
    message.taxels += robot.taxels;
  }
  std::string& out = message.updates;
  absl::StrAppend(&out, out.empty() ? "" : ",", "{\"server\":", server,
                  ",\"taxels\":", taxels,
                  ",\"update\":{\"stream_id\":", robot.id);
  if (!seen.opened) absl::StrAppend(&out, ",\"opened\":", robot.opened);
  if (!robot.counts.empty()) {
    absl::StrAppend(&out, ",\"counts\":", robot.counts);
  }
  if (has_frame) {
    absl::StrAppend(&out, ",\"frame\":", robot.frame);
    message.waited = std::max(
        message.waited, std::chrono::duration_cast<std::chrono::microseconds>(
                            now - robot.frame_time));
  }
  const uint64_t kept = robot.event_count - robot.events.size();
  // A browser that comes late has missed nothing; it sees those that are kept.
  if (!seen.opened) seen.events = kept;
  const uint64_t first = std::max(seen.events, kept);
  absl::StrAppend(&out, ",\"events_left_out\":", first - seen.events,
                  ",\"events\":[");
  for (uint64_t e = first; e < robot.event_count; ++e) {
    absl::StrAppend(&out, e > first ? "," : "", robot.events[e - kept]);
  }
  absl::StrAppend(&out, "],\"ended\":", robot.ended ? "true" : "false", "}}");
  seen = {.opened = true,
          .news = robot.news,
          .frame = robot.frames,
          .events = robot.event_count};
}

}  // namespace tactus::internal::console
