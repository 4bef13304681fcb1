// File: live_message.h
//
// The message of the console to its page that watches robots.
//
//   SendBinary(LiveMessage(feed->Read(cursor), RobotNews::Time::clock::now()));
//
// It is the length of its JSON, the JSON, and taxels: values of single
// precision, to whose places the JSON points. Thread-safe: a free function
// without state.
#pragma once

#include <string>
#include <vector>

#include "tools/console/live_feed.h"

namespace tactus::internal::console {

// `now` tells how long frames have waited.
std::string LiveMessage(const std::vector<ServerNews>& servers,
                        RobotNews::Time now);

}  // namespace tactus::internal::console
