#include "tools/console/foxglove_page.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/base/limits_console.h"
#include "core/base/limits_monitor.h"
#include "core/base/serialize.h"
#include "core/base/text.h"
#include "tools/console/foxglove_protocol.h"

namespace tactus::internal::console {
namespace {

using client::Json;

constexpr char kMalformed[] = "not a message of this protocol";

// The place of the channel of events among those of a robot.
uint32_t EventsChannel() {
  const auto& kinds = RobotChannels();
  return static_cast<uint32_t>(
      std::ranges::find(kinds, nullptr, &RobotChannel::encode) - kinds.begin());
}

std::optional<uint32_t> NumberOf(const Json& json) {
  if (!json.is_number_unsigned()) return std::nullopt;
  const auto number = json.get<uint64_t>();
  if (number > std::numeric_limits<uint32_t>::max()) return std::nullopt;
  return static_cast<uint32_t>(number);
}

// A number of an object; none if it is no object, or has no such number.
std::optional<uint32_t> NumberOf(const Json& json, const char* name) {
  if (!json.is_object()) return std::nullopt;
  const auto found = json.find(name);
  return found == json.end() ? std::nullopt : NumberOf(*found);
}

// A list of an object; null if it has no such list.
const Json* ListOf(const Json& json, const char* name) {
  const auto found = json.find(name);
  return found == json.end() || !found->is_array() ? nullptr : &*found;
}

// The time of the console's clock at which something came.
uint64_t LogTime(RobotNews::Time time, FoxglovePage::Now now) {
  const std::chrono::nanoseconds age = now.steady - time;
  return static_cast<uint64_t>(std::max<int64_t>(now.unix_ns - age.count(), 0));
}

}  // namespace

Viewer::Bounds FoxglovePage::bounds() const {
  return {.message_bytes = limits::kMaxFoxgloveMessageBytes,
          .messages_per_s = limits::kMaxFoxgloveMessagesPerS};
}

std::string FoxglovePage::Hear(const Message& message) {
  if (!message.is_text) {
    Remark("the console takes no messages of channels");
    return "";
  }
  const Json json = Json::parse(message.bytes, nullptr, false);
  if (!json.is_object()) return kMalformed;
  const auto op = json.find("op");
  if (op == json.end() || !op->is_string()) return kMalformed;
  if (*op == "subscribe") return Subscribe(json);
  if (*op == "unsubscribe") return Unsubscribe(json);
  Remark(absl::StrCat("the console does not know the operation ",
                      Quoted(op->get_ref<const std::string&>())));
  return "";
}

std::string FoxglovePage::Subscribe(const Json& message) {
  const Json* list = ListOf(message, "subscriptions");
  if (list == nullptr) return kMalformed;
  for (const Json& item : *list) {
    const auto subscription = NumberOf(item, "id");
    const auto channel = NumberOf(item, "channelId");
    if (!subscription || !channel) return kMalformed;
    SubscribeTo(*channel, *subscription);
  }
  return "";
}

void FoxglovePage::SubscribeTo(uint32_t id, uint32_t subscription) {
  const auto found = channels_.find(id);
  if (found == channels_.end()) {
    // A channel that was offered and has gone since is no mistake: the viewer
    // may not have heard. Its number is never used again.
    if (id > 0 && id < next_channel_) return;
    return Remark(absl::StrCat("there is no channel ", id));
  }
  if (found->second.subscription) {
    return Remark(absl::StrCat("channel ", id, " has a subscription already"));
  }
  if (!subscribed_.emplace(subscription, id).second) {
    return Remark(
        absl::StrCat("there is a subscription ", subscription, " already"));
  }
  found->second.subscription = subscription;
  SetDue(id);
}

// Unknown numbers are no mistake: a channel may just have gone.
std::string FoxglovePage::Unsubscribe(const Json& message) {
  const Json* list = ListOf(message, "subscriptionIds");
  if (list == nullptr) return kMalformed;
  for (const Json& item : *list) {
    const auto subscription = NumberOf(item);
    if (!subscription) return kMalformed;
    const auto found = subscribed_.find(*subscription);
    if (found == subscribed_.end()) continue;
    Channel& channel = channels_.at(found->second);
    channel.subscription.reset();
    if (channel.kind->encode == nullptr) channel.robot->events.clear();
    subscribed_.erase(found);
  }
  return "";
}

void FoxglovePage::Remark(const std::string& text) {
  if (remarks_.size() >= limits::kMaxFoxgloveRemarks) return;
  remarks_.push_back(FoxgloveRemark(text));
}

std::optional<Viewer::Message> FoxglovePage::Next(const LiveFeed& feed, bool) {
  const auto unix_time = std::chrono::system_clock::now().time_since_epoch();
  return Next(feed.Read(cursor_),
              {.steady = RobotNews::Time::clock::now(),
               .unix_ns = std::chrono::nanoseconds(unix_time).count()});
}

std::optional<Viewer::Message> FoxglovePage::Next(
    const std::vector<ServerNews>& servers, Now now) {
  for (size_t i = 0; i < servers.size(); ++i) Take(i, servers[i].news);
  const auto text = [](std::string bytes) {
    return Message{.bytes = std::move(bytes), .is_text = true};
  };
  if (auto greeting = NextGreeting()) return text(*std::move(greeting));
  if (auto data = NextOfEnded(now)) return Message{.bytes = *std::move(data)};
  if (auto gone = NextWithdrawal()) return text(*std::move(gone));
  if (auto remark = NextRemark()) return text(*std::move(remark));
  if (auto offer = NextOffer()) return text(*std::move(offer));
  if (auto data = NextDue(now)) return Message{.bytes = *std::move(data)};
  return std::nullopt;
}

void FoxglovePage::Take(size_t server, const RobotNews::News& news) {
  if (news.anew) {
    std::erase_if(robots_, [&](const auto& item) {
      if (item.first.first != server) return false;
      Withdraw(item.second);
      return true;
    });
  }
  for (const RobotUpdate& update : news.robots) {
    TakeUpdate({server, update.stream_id}, update);
  }
}

void FoxglovePage::TakeUpdate(const Key& key, const RobotUpdate& update) {
  if (update.opened != nullptr && !update.ended) {
    const v1::OpenStream& opened = update.opened->message;
    auto view = RobotView::Of(opened);
    if (!view.ok()) return;
    robots_.emplace(
        key, Robot{.view = *std::move(view), .name = opened.client_id()});
  }
  const auto found = robots_.find(key);
  if (found == robots_.end()) return;
  Robot& robot = found->second;
  if (update.frame != nullptr) {
    robot.frame = update.frame;
    robot.frame_time = update.frame_time;
    const auto count = static_cast<uint32_t>(RobotChannels().size());
    for (uint32_t i = 0; robot.first_channel > 0 && i < count; ++i) {
      if (RobotChannels()[i].encode != nullptr) SetDue(robot.first_channel + i);
    }
  }
  TakeEvents(update, robot);
  robot.ended = update.ended;
}

void FoxglovePage::TakeEvents(const RobotUpdate& update, Robot& robot) {
  if (!WantsEvents(robot)) return;
  robot.left_out += update.events_left_out;
  for (const auto& event : update.events) {
    robot.events.push_back(event);
    if (robot.events.size() <= limits::kMaxWatchedEvents) continue;
    robot.events.pop_front();
    ++robot.left_out;
  }
  if (!robot.events.empty()) SetDue(robot.first_channel + EventsChannel());
}

bool FoxglovePage::WantsEvents(const Robot& robot) const {
  return robot.first_channel > 0 &&
         channels_.at(robot.first_channel + EventsChannel()).subscription;
}

void FoxglovePage::SetDue(uint32_t id) {
  Channel& channel = channels_.at(id);
  if (channel.is_due || !channel.subscription) return;
  channel.is_due = true;
  due_.push_back(id);
}

void FoxglovePage::Withdraw(const Robot& robot) {
  if (robot.first_channel == 0) return;
  for (size_t i = 0; i < RobotChannels().size(); ++i) {
    const uint32_t id = robot.first_channel + static_cast<uint32_t>(i);
    const auto channel = channels_.find(id);
    if (channel->second.subscription) {
      subscribed_.erase(*channel->second.subscription);
    }
    if (channel->second.is_due) std::erase(due_, id);
    channels_.erase(channel);
    gone_.push_back(id);
  }
}

std::optional<std::string> FoxglovePage::NextGreeting() {
  if (std::exchange(greeted_, true)) return std::nullopt;
  return FoxgloveInfo(session_);
}

// The last events of a robot come before its channels go.
std::optional<std::string> FoxglovePage::NextOfEnded(Now now) {
  for (auto item = robots_.begin(); item != robots_.end();) {
    Robot& robot = item->second;
    if (robot.ended && !robot.events.empty()) return EventData(robot, now);
    if (robot.ended) Withdraw(robot);
    item = robot.ended ? robots_.erase(item) : std::next(item);
  }
  return std::nullopt;
}

std::optional<std::string> FoxglovePage::NextWithdrawal() {
  if (gone_.empty()) return std::nullopt;
  return FoxgloveWithdrawal(std::exchange(gone_, {}));
}

std::optional<std::string> FoxglovePage::NextRemark() {
  if (!remarks_.empty()) {
    std::string remark = std::move(remarks_.front());
    remarks_.pop_front();
    return remark;
  }
  for (auto& [key, robot] : robots_) {
    if (robot.left_out == robot.told) continue;
    robot.told = robot.left_out;
    return FoxgloveRemark(
        absl::StrCat(robot.told, " events of ", robot.topic,
                     " were left out, because this viewer reads too slowly"),
        robot.topic);
  }
  return std::nullopt;
}

std::optional<std::string> FoxglovePage::NextOffer() {
  const auto next = std::ranges::find(
      robots_, 0u, [](const auto& item) { return item.second.first_channel; });
  const auto& kinds = RobotChannels();
  if (next == robots_.end()) {
    // The protocol wants an offer at the beginning, if only an empty one.
    if (std::exchange(offered_, true)) return std::nullopt;
    return FoxgloveOffer({});
  }
  if (channels_.size() >= limits::kMaxFoxgloveRobots * kinds.size()) {
    if (std::exchange(full_, true)) return std::nullopt;
    return FoxgloveRemark(absl::StrCat(
        "more robots stream than the ", limits::kMaxFoxgloveRobots,
        " that are shown here; others follow when some of them end"));
  }
  offered_ = true;
  Robot& robot = next->second;
  robot.topic = TopicOf(next->first, robot);
  robot.first_channel = next_channel_;
  std::vector<FoxgloveChannel> offer;
  for (const RobotChannel& kind : kinds) {
    channels_[next_channel_] = {.robot = &robot, .kind = &kind};
    offer.push_back({.id = next_channel_++,
                     .topic = absl::StrCat(robot.topic, "/", kind.name),
                     .schema = &kind.schema});
  }
  return FoxgloveOffer(offer);
}

std::optional<std::string> FoxglovePage::NextDue(Now now) {
  while (!due_.empty()) {
    const uint32_t id = due_.front();
    due_.pop_front();
    Channel& channel = channels_.at(id);
    channel.is_due = false;
    if (!channel.subscription) continue;
    Robot& robot = *channel.robot;
    if (channel.kind->encode == nullptr) {
      if (robot.events.empty()) continue;
      std::string data = EventData(robot, now);
      if (!robot.events.empty()) SetDue(id);
      return data;
    }
    if (robot.frame == nullptr) continue;
    const std::string payload =
        channel.kind->encode(robot.view, robot.frame->message);
    if (payload.empty()) continue;
    return FoxgloveData(*channel.subscription, LogTime(robot.frame_time, now),
                        payload);
  }
  return std::nullopt;
}

std::string FoxglovePage::EventData(Robot& robot, Now now) {
  const auto event = std::move(robot.events.front());
  robot.events.pop_front();
  return FoxgloveData(
      *channels_.at(robot.first_channel + EventsChannel()).subscription,
      LogTime(now.steady, now), SerializeDeterministic(event->message));
}

std::string FoxglovePage::TopicOf(const Key& key, const Robot& robot) const {
  const auto is_free = [&](const std::string& topic) {
    return topic != "/" && std::ranges::none_of(robots_, [&](const auto& item) {
             return item.second.topic == topic;
           });
  };
  std::string topic = absl::StrCat("/", TopicPart(robot.name));
  if (is_free(topic)) return topic;
  const std::string stream = absl::StrCat("/", TopicPart(key.second));
  topic = stream;
  for (int i = 2; !is_free(topic); ++i) topic = absl::StrCat(stream, "-", i);
  return topic;
}

}  // namespace tactus::internal::console
