#include "tools/console/live_page.h"

#include "core/base/limits_console.h"
#include "tools/console/live_message.h"

namespace tactus::internal::console {

Viewer::Bounds LivePage::bounds() const {
  return {.message_bytes = limits::kMaxPageMessageBytes,
          .messages_per_s = limits::kMaxPageMessagesPerS};
}

std::string LivePage::Hear(const Message& message) {
  if (message.bytes != "next") return "not next";
  asked_ = true;
  return "";
}

std::optional<Viewer::Message> LivePage::Next(const LiveFeed& feed,
                                              bool even_if_old) {
  if (!asked_ || (!even_if_old && !feed.HasNews(cursor_))) return std::nullopt;
  asked_ = false;
  return Message{
      .bytes = LiveMessage(feed.Read(cursor_), RobotNews::Time::clock::now())};
}

}  // namespace tactus::internal::console
