// File: role.h
//
// Role: what a caller of the server may do. Each role may do what those before
// it may.
//
//   TACTUS_ASSIGN_OR_RETURN(const Role role, ParseRole("trainer"));
//   if (role < Role::kAdmin) Print(RoleName(role));
//
// Plain data and free functions; thread-safe.
#pragma once

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal {

enum class Role {
  // Classify, and see which models there are.
  kRobot,
  // See what the streams of others do.
  kViewer,
  // Datasets, jobs, models in and out.
  kTrainer,
  // Aliases and deletion.
  kAdmin,
};

// "robot", "viewer", "trainer" or "admin".
absl::string_view RoleName(Role role);

// INVALID_CONFIG for any other text.
absl::StatusOr<Role> ParseRole(absl::string_view name);

}  // namespace tactus::internal
