// File: monitor_command.h
//
// tactus-stream --monitor: shows a skin and the answers of a server in the
// terminal, ten times a second, until the user presses q or Ctrl-C.
//
//   TACTUS_RETURN_IF_ERROR(RunMonitor(channel, source->driver(), options));
//
// Once per process: it handles signals (tools/common/terminal.h).
#pragma once

#include <memory>

#include "absl/status/status.h"
#include "client/drivers/skin_driver.h"
#include "grpcpp/channel.h"
#include "tools/stream/live_player.h"

namespace tactus::internal::client {

// INVALID_CONFIG without a terminal; else how the stream ended.
absl::Status RunMonitor(const std::shared_ptr<grpc::Channel>& channel,
                        SkinDriver& driver, LivePlayer::Options options);

}  // namespace tactus::internal::client
