// File: robot_news.h
//
// RobotNews: what those who watch have not seen of the robots of one server.
//
//   RobotNews news;
//   news.Add(update, now);                     // as MonitorClient brings it
//   RobotNews::Cursor cursor;                  // of one watcher
//   for (const RobotUpdate& robot : news.Read(cursor).robots) Show(robot);
//
// A watcher that looks seldom gets the newest frame, and the last events. Each
// message becomes JSON once, whoever looks, and watchers share it: nothing is
// copied for one of them. Memory is bounded by the robots that a server shows
// with frames (limits_monitor.h). Not thread-safe; what Read returns is never
// changed, so any thread may use it.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tactus/v1/monitor.pb.h"

namespace tactus::internal::console {

// A message and its JSON.
template <class Message>
struct NewsItem {
  Message message;
  std::string json;
};
template <class Message>
using SharedItem = std::shared_ptr<const NewsItem<Message>>;

// What a watcher has not seen of a robot.
struct RobotUpdate {
  std::string stream_id = {};
  // Null if the robot was described before.
  SharedItem<v1::OpenStream> opened = {};
  // Null if the server has not counted yet.
  SharedItem<v1::StreamCounts> counts = {};
  // Null if there is no newer one. Its JSON is without taxels.
  SharedItem<v1::WatchedFrame> frame = {};
  // When the frame came.
  std::chrono::steady_clock::time_point frame_time = {};
  // The oldest first.
  std::vector<SharedItem<v1::WatchedEvent>> events = {};
  uint64_t events_left_out = 0;
  bool ended = false;
};

class RobotNews {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // What a watcher has seen.
  struct Seen {
    bool opened = false;
    uint64_t news = 0;
    uint64_t frame = 0;
    uint64_t events = 0;
    bool ended = false;
  };
  struct Cursor {
    uint64_t connection = 0;
    std::map<std::string, Seen> streams;
  };
  struct News {
    // True if the connection is another one: streams of the one before are
    // void.
    bool anew = false;
    std::vector<RobotUpdate> robots;
  };

  void Add(const v1::StreamUpdate& update, Time now);
  // The connection is lost: its streams are forgotten.
  void Clear();
  // True if Read would return a robot.
  bool HasNews(const Cursor& cursor) const;
  // Returns what is new and moves `cursor` on.
  News Read(Cursor& cursor) const;

 private:
  struct Robot {
    SharedItem<v1::OpenStream> opened;
    SharedItem<v1::StreamCounts> counts;
    SharedItem<v1::WatchedFrame> frame;
    Time frame_time;
    // How often something came, frames and events.
    uint64_t news = 0;
    uint64_t frames = 0;
    uint64_t event_count = 0;
    std::deque<SharedItem<v1::WatchedEvent>> events;
    bool ended = false;
  };

  static RobotUpdate UpdateOf(const std::string& id, const Robot& robot,
                              Seen& seen);
  // Keeps some of the newest of those that ended.
  void ForgetEnded();

  uint64_t connection_ = 1;
  uint64_t news_ = 0;
  std::map<std::string, Robot> robots_;
  // In the order in which they ended.
  std::deque<std::string> ended_;
};

}  // namespace tactus::internal::console
