// File: foxglove_protocol.h
//
// Messages of the WebSocket protocol of Foxglove
// (github.com/foxglove/ws-protocol, docs/spec.md), as far as a server sends
// them that is only watched.
//
//   SendText(FoxgloveInfo(session));
//   SendText(FoxgloveOffer({{.id = 1, .topic = "/arm/skin", ...}}));
//   SendBinary(FoxgloveData(subscription, time_ns, payload));
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "core/files/mcap/mcap_records.h"

namespace tactus::internal::console {

// The names of the protocol, the preferred one first.
inline constexpr absl::string_view kFoxgloveProtocols[] = {
    "foxglove.sdk.v1", "foxglove.websocket.v1"};

// One of the names above that a client offers in `header`, a list with commas;
// empty if it offers none.
std::string FoxgloveProtocolOf(absl::string_view header);

// The first message. `session` stays the same while a client may take two
// connections for one that was interrupted.
std::string FoxgloveInfo(const std::string& session);

struct FoxgloveChannel {
  uint32_t id = 0;
  std::string topic;
  // Protobuf.
  const McapSchema* schema = nullptr;
};
std::string FoxgloveOffer(const std::vector<FoxgloveChannel>& channels);
std::string FoxgloveWithdrawal(const std::vector<uint32_t>& channels);

// A remark that the client shows as a warning, in place of the one before with
// the same `id`; empty: beside all others.
std::string FoxgloveRemark(const std::string& text, const std::string& id = "");

// A message of a channel, binary.
std::string FoxgloveData(uint32_t subscription, uint64_t time_ns,
                         absl::string_view payload);

}  // namespace tactus::internal::console
