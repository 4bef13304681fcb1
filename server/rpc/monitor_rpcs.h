// File: monitor_rpcs.h
//
// The RPCs of MonitorService.
//
//   AddMonitorRpcs(&open_streams, control);
//
// `streams` must outlive the calls. Not thread-safe: call it before the server
// starts.
#pragma once

#include "server/monitor/open_streams.h"
#include "server/rpc/control_service.h"

namespace tactus::internal::server {

void AddMonitorRpcs(OpenStreams* streams, ControlService& control);

}  // namespace tactus::internal::server
