// File: viewer.h
//
// Viewer: what the console says to somebody who watches robots over a
// WebSocket, and what it makes of what it hears. WatchSocket carries it.
//
//   std::string why = viewer.Hear(message);     // not empty: the end
//   while (auto message = viewer.Next(feed, false)) Send(*message);
//
// One message is asked for after the other, each when the one before is gone.
// So a viewer keeps no queue: it looks at the feed when it is asked. For the
// thread that serves browsers.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "tools/console/live_feed.h"

namespace tactus::internal::console {

class Viewer {
 public:
  struct Message {
    std::string bytes;
    bool is_text = false;
  };
  // What the other side may send: bytes of a message, and messages a second.
  struct Bounds {
    size_t message_bytes = 0;
    int messages_per_s = 0;
  };

  virtual ~Viewer() = default;

  virtual Bounds bounds() const = 0;
  // Returns why the connection must end, in at most 100 characters; empty if it
  // goes on.
  virtual std::string Hear(const Message& message) = 0;
  // What to send next; nothing if there is nothing new. With `even_if_old`,
  // nothing was sent for a second.
  virtual std::optional<Message> Next(const LiveFeed& feed,
                                      bool even_if_old) = 0;
};

}  // namespace tactus::internal::console
