// File: doctor_remote.h
//
// The checks of `trainctl doctor` on a server.
//
//   return PrintChecks(CheckServer(flags), flags.json);
//
// Thread-safe: a free function without state.
#pragma once

#include <vector>

#include "core/store/data_check.h"
#include "tools/trainctl/remote/flags.h"

namespace tactus::internal::client {

// Checks, in this order, and ends where nothing further can be checked: the
// certificate, the connection and the credential, versions, clock, data
// directory, what streams get.
std::vector<CheckResult> CheckServer(const RemoteFlags& flags);

}  // namespace tactus::internal::client
