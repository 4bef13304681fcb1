// File: service_notify.h
//
// Notifications to systemd (sd_notify(3)): the server is ready, it is stopping,
// it is still alive.
//
//   NotifyService("READY=1");
//   NotifyService("WATCHDOG=1");   // more often than the unit's WatchdogSec
//
// One datagram to the socket named by $NOTIFY_SOCKET, which is all that the
// protocol asks for; libsystemd would be a dependency for these few lines.
// Thread-safe as long as nobody changes the environment.
#pragma once

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace tactus::internal::server {

// Sends `state` if systemd started this process; does nothing otherwise. IO if
// systemd is there but cannot be reached.
absl::Status NotifyService(absl::string_view state);

}  // namespace tactus::internal::server
