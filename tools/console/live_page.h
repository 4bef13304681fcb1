// File: live_page.h
//
// LivePage: the viewer that is the console's own page. The page asks for each
// message: it gets what is newest when it has time for it.
//
//   LivePage page;
//   page.Hear({.bytes = "next"});
//   const auto message = page.Next(feed, false);   // live_message.h
//
// The page sends "next"; the answer comes when there is something new, or after
// a second. Other messages end the connection. For the thread that serves
// browsers.
#pragma once

#include <optional>
#include <string>

#include "tools/console/viewer.h"

namespace tactus::internal::console {

class LivePage final : public Viewer {
 public:
  Bounds bounds() const override;
  std::string Hear(const Message& message) override;
  std::optional<Message> Next(const LiveFeed& feed, bool even_if_old) override;

 private:
  LiveFeed::Cursor cursor_;
  bool asked_ = false;
};

}  // namespace tactus::internal::console
