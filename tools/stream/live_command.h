// File: live_command.h
//
// What tactus-stream does with a real skin: prints contacts as they end, and
// the skin's statistics at the end. Ctrl-C ends it.
//
//   TACTUS_RETURN_IF_ERROR(RunLive(channel, source->driver(), options));
//
// Once per process: it handles SIGINT and SIGTERM.
#pragma once

#include <memory>

#include "absl/status/status.h"
#include "client/drivers/skin_driver.h"
#include "grpcpp/channel.h"
#include "tools/stream/live_player.h"

namespace tactus::internal::client {

// With `json`, each line of standard output is one JSON object.
absl::Status RunLive(const std::shared_ptr<grpc::Channel>& channel,
                     SkinDriver& driver, const LivePlayer::Options& options,
                     bool json);

}  // namespace tactus::internal::client
