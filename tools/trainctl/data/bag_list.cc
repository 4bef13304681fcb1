#include "tools/trainctl/data/bag_list.h"

#include <iostream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/import/ros2/bag_summary.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

Json TopicJson(const BagTopicSummary& each) {
  const auto text_or_null = [](const std::string& text) {
    return text.empty() ? Json(nullptr) : Json(text);
  };
  return {{"name", each.topic.name},
          {"type", each.topic.type},
          {"encoding", each.topic.encoding},
          {"messages", each.messages},
          {"rate_hz", each.rate_hz},
          {"shape", each.shape.empty() ? Json(nullptr) : Json(each.shape)},
          {"axes", each.shape.empty() ? Json(nullptr) : Json(each.axes)},
          {"field", text_or_null(each.field)},
          {"unread", text_or_null(each.unread)}};
}

Json SummaryJson(const std::string& path, const BagSummary& summary,
                 const std::string& skin) {
  Json topics = Json::array();
  for (const BagTopicSummary& each : summary.topics) {
    topics.push_back(TopicJson(each));
  }
  return {{"bag", path},
          {"storage", summary.storage},
          {"files", summary.files},
          {"compression", summary.compressions},
          {"cut_off", summary.cut_off},
          {"messages", summary.messages},
          {"seconds", summary.seconds},
          {"topics", topics},
          {"mapping", skin.empty() ? Json(nullptr) : Json::parse(skin)}};
}

std::string ShapeText(const BagTopicSummary& each) {
  if (each.shape.empty()) return "-";
  return absl::StrCat(absl::StrJoin(each.shape, " x "), " in ", each.field);
}

}  // namespace

absl::Status ListBag(const std::string& path, bool json) {
  TACTUS_ASSIGN_OR_RETURN(const BagSummary summary, SummarizeBag(path));
  const std::string skin = SkinToStartFrom(summary);
  if (json) {
    std::cout << JsonText(SummaryJson(path, summary, skin)) << "\n";
    return absl::OkStatus();
  }
  std::cout << absl::StrFormat(
      "%s: %s, %d files, %d messages in %.3f s, compression: %s\n",
      Printable(path), summary.storage, summary.files.size(), summary.messages,
      summary.seconds,
      summary.compressions.empty() ? "none"
                                   : absl::StrJoin(summary.compressions, ", "));
  for (const std::string& text : summary.cut_off) {
    std::cout << Printable(text) << "\n";
  }
  for (const BagTopicSummary& each : summary.topics) {
    std::cout << absl::StrFormat(
        "  %s  %s, %s, %d messages, %.4g Hz, taxels: %s\n",
        Printable(each.topic.name), Printable(each.topic.type),
        Printable(each.topic.encoding), each.messages, each.rate_hz,
        Printable(ShapeText(each)));
  }
  if (skin.empty()) {
    std::cout << "No topic has taxels; --list --json says why of each.\n";
    return absl::OkStatus();
  }
  std::cout << "A mapping to start from; correct the shape, the pitches, unit, "
               "scale and idle_frames, then\n"
               "trainctl import "
            << Printable(path)
            << " --mapping=skin.json --label=LABEL --out=mine.h5\n"
            << skin << "\n";
  return absl::OkStatus();
}

}  // namespace tactus::internal::client
