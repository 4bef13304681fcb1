// File: robot_news.h
//
// RobotNews: what browsers have not seen of the robots of one server.
//
//   RobotNews news;
//   news.Add(update, now);                     // as MonitorClient brings it
//   RobotNews::Cursor cursor;                  // of one browser
//   RobotNews::Message message;
//   news.Write(cursor, /*server=*/0, now, message);
//
// A browser that looks seldom gets the newest frame, and the last events. Each
// update becomes JSON once, whoever looks. Memory is bounded by the robots that
// a server shows with frames (limits_monitor.h). Not thread-safe.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "tactus/v1/monitor.pb.h"

namespace tactus::internal::console {

class RobotNews {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // What a browser has seen.
  struct Seen {
    bool opened = false;
    uint64_t news = 0;
    uint64_t frame = 0;
    uint64_t events = 0;
  };
  struct Cursor {
    uint64_t connection = 0;
    std::map<std::string, Seen> streams;
  };
  // What a browser is sent.
  struct Message {
    // Objects of JSON, with commas between them.
    std::string updates;
    // Values of single precision in the memory's order.
    std::string taxels;
    // The longest time that a frame of it has waited.
    std::chrono::microseconds waited{0};
  };

  void Add(const v1::StreamUpdate& update, Time now);
  // The connection is lost: its streams are forgotten.
  void Clear();
  // True if Write would write something.
  bool HasNews(const Cursor& cursor) const;
  // Adds what is new to `message` and moves `cursor` on.
  void Write(Cursor& cursor, int server, Time now, Message& message) const;

 private:
  struct Robot {
    // JSON.
    std::string id;
    std::string opened;
    std::string counts;
    std::string frame;
    std::string taxels;
    Time frame_time;
    // How often something came, frames and events.
    uint64_t news = 0;
    uint64_t frames = 0;
    uint64_t event_count = 0;
    std::deque<std::string> events;
    bool ended = false;
  };

  static void WriteRobot(const Robot& robot, int server, Time now, Seen& seen,
                         Message& message);
  // Keeps some of the newest of those that ended.
  void ForgetEnded();

  uint64_t connection_ = 1;
  uint64_t news_ = 0;
  std::map<std::string, Robot> robots_;
  // In the order in which they ended.
  std::deque<std::string> ended_;
};

}  // namespace tactus::internal::console
