#include "tools/console/foxglove_protocol.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/version.h"
#include "tools/common/json.h"

namespace tactus::internal::console {
namespace {

using client::Json;
using client::JsonText;

constexpr int kWarning = 1;
constexpr uint8_t kMessageData = 1;

}  // namespace

std::string FoxgloveProtocolOf(absl::string_view header) {
  std::vector<absl::string_view> offered = absl::StrSplit(header, ',');
  for (auto& name : offered) name = absl::StripAsciiWhitespace(name);
  const auto* found =
      std::ranges::find_if(kFoxgloveProtocols, [&](absl::string_view name) {
        return std::ranges::find(offered, name) != offered.end();
      });
  return found == std::end(kFoxgloveProtocols) ? "" : std::string(*found);
}

std::string FoxgloveInfo(const std::string& session) {
  return JsonText({{"op", "serverInfo"},
                   {"name", absl::StrCat("tactus-console ", kVersion)},
                   {"capabilities", Json::array()},
                   {"sessionId", session}});
}

std::string FoxgloveOffer(const std::vector<FoxgloveChannel>& channels) {
  Json list = Json::array();
  for (const FoxgloveChannel& channel : channels) {
    list.push_back({{"id", channel.id},
                    {"topic", channel.topic},
                    {"encoding", "protobuf"},
                    {"schemaName", channel.schema->name},
                    {"schemaEncoding", channel.schema->encoding},
                    {"schema", absl::Base64Escape(channel.schema->data)}});
  }
  return JsonText({{"op", "advertise"}, {"channels", std::move(list)}});
}

std::string FoxgloveWithdrawal(const std::vector<uint32_t>& channels) {
  return JsonText({{"op", "unadvertise"}, {"channelIds", channels}});
}

std::string FoxgloveRemark(const std::string& text, const std::string& id) {
  Json json = {{"op", "status"}, {"level", kWarning}, {"message", text}};
  if (!id.empty()) json["id"] = id;
  return JsonText(json);
}

std::string FoxgloveData(uint32_t subscription, uint64_t time_ns,
                         absl::string_view payload) {
  std::string bytes;
  PutMcapNumber(kMessageData, &bytes);
  PutMcapNumber(subscription, &bytes);
  PutMcapNumber(time_ns, &bytes);
  bytes.append(payload.data(), payload.size());
  return bytes;
}

}  // namespace tactus::internal::console
