// File: open_streams.h
//
// OpenStreams: the streams that are open and configured, for those who watch.
//
//   const auto stream = streams.Add(std::move(description));
//   for (const auto& open : streams.List()) Show(open->Describe(now_ns));
//   streams.Remove(stream.get());
//
// Thread-safe. Add and Remove run once per stream.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/monitor/watched_stream.h"

namespace tactus::internal::server {

class OpenStreams {
 public:
  // While somebody follows, new streams are watched from their first frame.
  void AddFollower() { ++followers_; }
  void RemoveFollower() { --followers_; }

  std::shared_ptr<WatchedStream> Add(v1::OpenStream description);
  // Ends it too. Watchers that have it may keep it.
  void Remove(const WatchedStream* stream);

  // The oldest first.
  std::vector<std::shared_ptr<WatchedStream>> List() const;
  // Null if there is none of this id.
  std::shared_ptr<WatchedStream> Find(const std::string& id) const;

 private:
  std::atomic<int> followers_ = 0;
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<WatchedStream>> streams_;
};

}  // namespace tactus::internal::server
