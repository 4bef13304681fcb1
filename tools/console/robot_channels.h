// File: robot_channels.h
//
// What programs like Foxglove can watch of a robot: its channels. Here and
// nowhere else it stands which schema a channel has, and what its messages are.
//
//   TACTUS_ASSIGN_OR_RETURN(const RobotView view, RobotView::Of(opened));
//   for (const RobotChannel& channel : RobotChannels()) {
//     Advertise(topic + "/" + channel.name, channel.schema);
//     if (channel.encode) Send(channel.encode(view, frame));
//   }
//
// Thread-safe: free functions without state, and plain data.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/data/recording/foxglove_contacts.h"
#include "core/data/recording/foxglove_image.h"
#include "tactus/v1/monitor.pb.h"

namespace tactus::internal::console {

// What messages about a robot need to know of it.
struct RobotView {
  SkinLayout layout;
  FoxgloveImage image;
  FoxgloveContacts contacts;

  // INVALID_CONFIG if the skin is none that there can be.
  static absl::StatusOr<RobotView> Of(const v1::OpenStream& opened);
};

struct RobotChannel {
  // The last part of its topic.
  std::string name;
  // Protobuf, as are the messages.
  McapSchema schema;
  // The message of a frame; empty if the frame has nothing for the channel.
  // Null for the channel of events, whose messages are the events.
  std::string (*encode)(const RobotView& robot,
                        const v1::WatchedFrame& frame) = nullptr;
};

const std::vector<RobotChannel>& RobotChannels();

// A robot's name as a part of a topic: what is no letter, digit, dash or
// underscore becomes an underscore.
std::string TopicPart(absl::string_view name);

}  // namespace tactus::internal::console
