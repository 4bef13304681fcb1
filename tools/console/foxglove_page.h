// File: foxglove_page.h
//
// FoxglovePage: the viewer that is Foxglove, Lichtblick, or another program
// that speaks their protocol. It is offered the channels of each robot
// (robot_channels.h), and gets the newest frame of those to which it has
// subscribed, and events.
//
//   FoxglovePage page(session);
//   page.Hear({.bytes = R"({"op": "subscribe", ...})", .is_text = true});
//   while (auto message = page.Next(feed, false)) Send(*message);
//
// A viewer that reads slowly gets fewer frames and never old ones; the last
// events wait for it, and it hears how many were left out. What it says that is
// no JSON, or not of the protocol's form, ends the connection; what the console
// cannot do is answered by a remark. For the thread that serves browsers.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/common/json.h"
#include "tools/console/robot_channels.h"
#include "tools/console/viewer.h"

namespace tactus::internal::console {

class FoxglovePage final : public Viewer {
 public:
  // The times of the console's clocks.
  struct Now {
    RobotNews::Time steady;
    // Nanoseconds since 1970.
    int64_t unix_ns = 0;
  };

  // `session`: see FoxgloveInfo.
  explicit FoxglovePage(std::string session) : session_(std::move(session)) {}

  Bounds bounds() const override;
  std::string Hear(const Message& message) override;
  std::optional<Message> Next(const LiveFeed& feed, bool even_if_old) override;
  // The same with what is new of the servers.
  std::optional<Message> Next(const std::vector<ServerNews>& servers, Now now);

 private:
  // The number of a server, and a stream of it.
  using Key = std::pair<size_t, std::string>;

  struct Robot {
    RobotView view;
    // What the robot calls itself.
    std::string name;
    // Empty as long as its channels are not offered.
    std::string topic = {};
    uint32_t first_channel = 0;
    // The newest one.
    SharedItem<v1::WatchedFrame> frame = {};
    RobotNews::Time frame_time = {};
    // Events that wait to be sent.
    std::deque<SharedItem<v1::WatchedEvent>> events = {};
    // How many were left out, and of how many the viewer has heard.
    uint64_t left_out = 0;
    uint64_t told = 0;
    bool ended = false;
  };
  // One that is offered.
  struct Channel {
    Robot* robot = nullptr;
    const RobotChannel* kind = nullptr;
    std::optional<uint32_t> subscription = std::nullopt;
    // Waits in `due_`.
    bool is_due = false;
  };

  std::string Subscribe(const client::Json& message);
  std::string Unsubscribe(const client::Json& message);
  void SubscribeTo(uint32_t channel, uint32_t subscription);
  void Remark(const std::string& text);

  void Take(size_t server, const RobotNews::News& news);
  void TakeUpdate(const Key& key, const RobotUpdate& update);
  void TakeEvents(const RobotUpdate& update, Robot& robot);
  void SetDue(uint32_t id);
  // True if the robot is offered and the viewer has subscribed to its events.
  bool WantsEvents(const Robot& robot) const;
  void Withdraw(const Robot& robot);

  // What to send next, of each kind.
  std::optional<std::string> NextGreeting();
  std::optional<std::string> NextOfEnded(Now now);
  std::optional<std::string> NextWithdrawal();
  std::optional<std::string> NextRemark();
  std::optional<std::string> NextOffer();
  std::optional<std::string> NextDue(Now now);

  std::string TopicOf(const Key& key, const Robot& robot) const;
  // Takes an event from those that wait.
  std::string EventData(Robot& robot, Now now);

  const std::string session_;
  LiveFeed::Cursor cursor_;
  bool greeted_ = false;
  bool offered_ = false;
  // The viewer has heard that there are too many robots.
  bool full_ = false;
  std::map<Key, Robot> robots_;
  std::map<uint32_t, Channel> channels_;
  uint32_t next_channel_ = 1;
  // Channels by the viewer's numbers of its subscriptions.
  std::map<uint32_t, uint32_t> subscribed_;
  // Channels that have something to send, the longest wait first.
  std::deque<uint32_t> due_;
  std::deque<std::string> remarks_;
  // Channels of robots that are gone, which the viewer has not heard.
  std::vector<uint32_t> gone_;
};

}  // namespace tactus::internal::console
