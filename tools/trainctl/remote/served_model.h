// File: served_model.h
//
// ServedModel: what a server's model thinks of a skin that is being recorded.
// Recording goes on without it: a failure ends the stream and is reported once.
//
//   ServedModel model(&monitor);
//   std::string problem = model.Open(channel, info, "models/arm", token);
//   problem = model.Send(frame);
//
// Answers go to the monitor. Not thread-safe.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "client/stream/contact_stream.h"
#include "client/stream/frame_encoder.h"
#include "grpcpp/channel.h"
#include "tools/common/monitor.h"

namespace tactus::internal::client {

class ServedModel {
 public:
  // `monitor` outlives this.
  explicit ServedModel(Monitor* monitor) : monitor_(monitor) {}

  // Returns what is wrong; empty if the server accepted the skin.
  std::string Open(const std::shared_ptr<grpc::Channel>& channel,
                   const SkinInfo& info, const std::string& model,
                   const std::string& token);
  // Sends a frame if there is a stream, and shows it to the monitor. Returns
  // why the stream ended, once.
  std::string Send(const SkinFrame& frame);
  // A recorded or simulated trial is over; returns as Send does.
  std::string EndTrial();

 private:
  std::string Ended(absl::Status status);

  Monitor* const monitor_;
  std::optional<FrameEncoder> encoder_;
  std::unique_ptr<ContactStream> stream_;
};

}  // namespace tactus::internal::client
