// File: live_replicas.h
//
// The servers and workers that are at work on a shared catalogue, for a program
// that is none of them.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const std::vector<std::string> live,
//       LiveReplicas(*catalog, std::chrono::milliseconds(11'000)));
//   for (const std::string& name : live) Print(name);
//
// Thread-safe: a free function without state.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/store/catalog.h"

namespace tactus::internal {

// Watches the signs of life, at most for `patience`: one that does not give any
// in this time is dead. Returns at once if nothing is registered. Each is named
// as "replicas/3 (host, address)".
absl::StatusOr<std::vector<std::string>> LiveReplicas(
    const Catalog& catalog, std::chrono::milliseconds patience);

}  // namespace tactus::internal
