#include "tools/console/live_message.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "tools/common/json.h"

namespace tactus::internal::console {
namespace {

static_assert(std::endian::native == std::endian::little,
              "lengths and taxels are sent as they lie in memory");

// Adds the JSON of an update to `out`, and the frame's taxels to `taxels`.
void WriteUpdate(const RobotUpdate& robot, size_t server, std::string& out,
                 std::string& taxels) {
  int64_t place = -1;
  if (robot.frame != nullptr && !robot.frame->message.taxels().empty()) {
    place = static_cast<int64_t>(taxels.size() / sizeof(float));
    taxels += robot.frame->message.taxels();
  }
  absl::StrAppend(&out, out.empty() ? "" : ",", "{\"server\":", server,
                  ",\"taxels\":", place, ",\"update\":{\"stream_id\":",
                  client::JsonText(robot.stream_id));
  const auto add = [&](const char* name, const auto& item) {
    if (item == nullptr) return;
    absl::StrAppend(&out, ",\"", name, "\":", item->json);
  };
  add("opened", robot.opened);
  add("counts", robot.counts);
  add("frame", robot.frame);
  absl::StrAppend(&out, ",\"events_left_out\":", robot.events_left_out,
                  ",\"events\":[");
  for (const auto& event : robot.events) {
    absl::StrAppend(&out, event == robot.events.front() ? "" : ",",
                    event->json);
  }
  absl::StrAppend(&out, "],\"ended\":", robot.ended ? "true" : "false", "}}");
}

}  // namespace

std::string LiveMessage(const std::vector<ServerNews>& servers,
                        RobotNews::Time now) {
  using std::chrono::microseconds;
  client::Json states = client::Json::array();
  std::string updates;
  std::string taxels;
  // The longest time that a frame has waited.
  microseconds waited{0};
  for (size_t i = 0; i < servers.size(); ++i) {
    states.push_back({{"address", servers[i].address},
                      {"state", servers[i].state},
                      {"error", servers[i].error}});
    for (const RobotUpdate& robot : servers[i].news.robots) {
      WriteUpdate(robot, i, updates, taxels);
      if (robot.frame == nullptr) continue;
      waited = std::max(waited, std::chrono::duration_cast<microseconds>(
                                    now - robot.frame_time));
    }
  }
  const int64_t now_ms =
      std::chrono::duration_cast<std::chrono::milliseconds>(
          std::chrono::system_clock::now().time_since_epoch())
          .count();
  std::string json = absl::StrCat(
      "{\"servers\":", client::JsonText(states), ",\"updates\":[", updates,
      "],\"console_time_ms\":", now_ms, ",\"waited_us\":", waited.count(), "}");
  uint32_t length = static_cast<uint32_t>(json.size());
  length = (length + 3) & ~uint32_t{3};
  json.resize(length, ' ');
  std::string bytes(sizeof length, '\0');
  std::memcpy(bytes.data(), &length, sizeof length);
  return absl::StrCat(bytes, json, taxels);
}

}  // namespace tactus::internal::console
