// File: live_feed.h
//
// LiveFeed: watches the robots of all servers of a console for one person, as
// long as one of the person's pages is open.
//
//   auto feed = std::make_shared<LiveFeed>(servers, token);
//   const int id = feed->Subscribe([] { WakePage(); });  // on any thread
//   LiveFeed::Cursor cursor;
//   if (feed->HasNews(cursor)) Send(feed->Read(cursor));
//   feed->Unsubscribe(id);
//
// A thread per server watches it, and connects again after a loss. Thread-safe;
// a cursor is for one thread. The destructor ends the calls and waits for it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "tools/console/robot_news.h"
#include "tools/console/server_address.h"

namespace tactus::internal::console {

// What is new of a server and its robots.
struct ServerNews {
  std::string address = {};
  // "connecting", "connected" or "refused".
  std::string state = {};
  std::string error = {};
  RobotNews::News news = {};
};

class LiveFeed {
 public:
  struct Cursor {
    std::vector<RobotNews::Cursor> servers;
    // The states that were seen.
    uint64_t states = 0;
  };

  LiveFeed(const std::vector<ServerAddress>& servers, const std::string& token);
  ~LiveFeed();

  LiveFeed(const LiveFeed&) = delete;
  LiveFeed& operator=(const LiveFeed&) = delete;

  // Calls `on_news` when there may be something new, until Unsubscribe returns.
  int Subscribe(std::function<void()> on_news);
  void Unsubscribe(int id);

  // True if no server lets the person watch.
  bool IsRefused() const;
  bool HasNews(const Cursor& cursor) const;
  // One entry for each server, in their order. Moves `cursor` on.
  std::vector<ServerNews> Read(Cursor& cursor) const;

 private:
  class Watch;

  void OnNews();

  mutable std::mutex mutex_;
  std::map<int, std::function<void()>> subscribers_;
  int next_id_ = 0;
  std::vector<std::unique_ptr<Watch>> watches_;
};

}  // namespace tactus::internal::console
