#include "core/import/ros2/bag_summary.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/import/ros2/ros2_taxels.h"
#include "core/import/ros2/ros2_type.h"
#include "nlohmann/json.hpp"

namespace tactus::internal {
namespace {

// Sets what the first message says; returns why it says nothing.
absl::Status LookInto(absl::string_view bytes, BagTopicSummary& summary) {
  const BagTopic& topic = summary.topic;
  TACTUS_ASSIGN_OR_RETURN(const Ros2Type type,
                          Ros2Type::Parse(topic.type, topic.definition));
  TACTUS_ASSIGN_OR_RETURN(const Ros2Message message, type.Read(bytes));
  TACTUS_ASSIGN_OR_RETURN(Ros2Taxels taxels, TaxelsOf(topic.type, message, ""));
  summary.field = std::move(taxels.field);
  summary.shape = std::move(taxels.shape);
  summary.axes = taxels.axes;
  summary.has_negative =
      std::any_of(taxels.numbers.begin(), taxels.numbers.end(),
                  [](double number) { return number < 0; });
  return absl::OkStatus();
}

// The rows, columns and axes that a skin may have; zero rows for none.
struct SkinShape {
  size_t rows = 0;
  size_t columns = 0;
  size_t axes = 1;
};

SkinShape SkinShapeOf(const BagTopicSummary& each) {
  std::vector<size_t> shape = each.shape;
  SkinShape skin;
  skin.axes = each.axes;
  if (skin.axes > 1) shape.pop_back();
  if (shape.empty() || shape.size() > 2) return {};
  skin.columns = shape.back();
  skin.rows = shape.size() == 2 ? shape.front() : 1;
  // A long list becomes rows of the largest length that divides it.
  while (skin.rows == 1 && skin.columns > limits::kMaxColumns) {
    const size_t taxels = skin.columns;
    size_t columns = limits::kMaxColumns;
    while (taxels % columns != 0) --columns;
    skin.rows = taxels / columns;
    skin.columns = columns;
    if (columns == 1) return {};
  }
  if (skin.rows == 0 || skin.columns == 0 || skin.rows > limits::kMaxRows ||
      skin.columns > limits::kMaxColumns) {
    return {};
  }
  return skin;
}

// "/hand/left/tactile" as "hand-left-tactile".
std::string SkinName(absl::string_view topic) {
  std::string name;
  for (const char letter : topic) {
    if (absl::ascii_isalnum(letter)) {
      name += absl::ascii_tolower(letter);
    } else if (!name.empty() && name.back() != '-') {
      name += '-';
    }
  }
  while (!name.empty() && name.back() == '-') name.pop_back();
  return name.empty() ? "skin" : name.substr(0, 40);
}

// The topic of poses if there is one only: which of several is the skin's, a
// person knows.
std::string PoseTopicOf(const BagSummary& summary) {
  std::string topic;
  for (const BagTopicSummary& each : summary.topics) {
    if (each.messages == 0 ||
        each.topic.type != "geometry_msgs/msg/PoseStamped") {
      continue;
    }
    if (!topic.empty()) return "";
    topic = each.topic.name;
  }
  return topic;
}

}  // namespace

absl::StatusOr<BagSummary> SummarizeBag(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const auto bag, Ros2Bag::Open(path));
  BagSummary summary;
  int64_t first_ns = 0;
  int64_t last_ns = 0;
  while (true) {
    TACTUS_ASSIGN_OR_RETURN(const BagMessage* const message, bag->Next());
    summary.topics.resize(bag->topics().size());
    if (message == nullptr) break;
    BagTopicSummary& each = summary.topics[message->topic];
    const int64_t time = message->time_ns;
    if (each.messages++ == 0) {
      each.topic = bag->topics()[message->topic];
      each.first_ns = each.last_ns = time;
      if (each.topic.encoding == "cdr") {
        each.unread = Printable(LookInto(message->data, each).message());
      } else {
        each.unread =
            absl::StrCat("is encoded as ", Quoted(each.topic.encoding));
      }
    }
    each.first_ns = std::min(each.first_ns, time);
    each.last_ns = std::max(each.last_ns, time);
    first_ns = summary.messages == 0 ? time : std::min(first_ns, time);
    last_ns = summary.messages == 0 ? time : std::max(last_ns, time);
    ++summary.messages;
  }
  for (size_t i = 0; i < summary.topics.size(); ++i) {
    BagTopicSummary& each = summary.topics[i];
    each.topic = bag->topics()[i];
    if (each.messages == 0) each.unread = "has no message";
    const double seconds = SecondsBetween(each.first_ns, each.last_ns);
    if (each.messages > 1 && seconds > 0) {
      each.rate_hz = static_cast<double>(each.messages - 1) / seconds;
    }
  }
  std::sort(summary.topics.begin(), summary.topics.end(),
            [](const auto& a, const auto& b) {
              return std::tie(a.topic.name, a.topic.type) <
                     std::tie(b.topic.name, b.topic.type);
            });
  summary.storage = bag->storage();
  summary.files = bag->files();
  summary.compressions = bag->compressions();
  summary.cut_off = bag->cut_off();
  summary.seconds = SecondsBetween(first_ns, last_ns);
  return summary;
}

std::string SkinToStartFrom(const BagSummary& summary) {
  const BagTopicSummary* best = nullptr;
  const auto rank = [](const BagTopicSummary& each) {
    const SkinShape shape = SkinShapeOf(each);
    return std::tuple(!absl::EndsWith(each.topic.type, "/Image"),
                      shape.rows * shape.columns * shape.axes > 1,
                      each.messages);
  };
  for (const BagTopicSummary& each : summary.topics) {
    if (SkinShapeOf(each).rows == 0) continue;
    if (best == nullptr || rank(each) > rank(*best)) best = &each;
  }
  if (best == nullptr) return "";
  const SkinShape shape = SkinShapeOf(*best);
  constexpr double kPitchM = 0.005;
  nlohmann::ordered_json json = {{"name", SkinName(best->topic.name)},
                                 {"dataset", best->topic.name},
                                 {"bag_values", best->field}};
  const std::string pose_topic = PoseTopicOf(summary);
  if (!pose_topic.empty()) json["pose_topic"] = pose_topic;
  json.update({{"rows", shape.rows},
               {"columns", shape.columns},
               {"row_pitch_m", kPitchM},
               {"column_pitch_m", kPitchM},
               {"unit", "counts"},
               {"scale", 1},
               {"thresholds", "from idle frames"},
               {"idle_frames", 20}});
  if (shape.axes == 3) {
    json["axes"] = 3;
    json["signed_values"] = true;
    json["baseline"] = "from idle frames";
  } else if (best->has_negative) {
    json["baseline"] = "from idle frames";
    json["negative_values"] = "absolute";
  }
  if (best->rate_hz >= limits::kMinSampleRateHz &&
      best->rate_hz <= limits::kMaxSampleRateHz) {
    const double unit =
        std::pow(10.0, std::floor(std::log10(best->rate_hz)) - 2);
    json["sample_rate_hz"] = std::round(best->rate_hz / unit) * unit;
  }
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace tactus::internal
