// File: default_bundle.h
//
// The model bundles built into tactusd, byte for byte: for streams with poses
// of the arm (server/registry/default.tactus) and for streams without
// (no-poses.tactus). Thread-safe; they live as long as the program.
#pragma once

#include "absl/strings/string_view.h"

namespace tactus::internal::server {

absl::string_view DefaultBundle();
absl::string_view NoPosesBundle();

}  // namespace tactus::internal::server
