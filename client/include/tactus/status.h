// File: status.h
//
// Errors of Tactus: an absl::Status that says what was wrong, its value and
// what would be right. Programs react to its reason, which never changes, and
// not to its text, which may.
//
//   const auto stream = client.Open({.name = "cody-forearm"});
//   if (!stream.ok() && ReasonOf(stream.status()) == "MODEL_NOT_FOUND") {
//     ChooseAnotherModel();
//   }
//
// The reasons are the names of tactus.v1.ErrorReason without their prefix.
// Thread-safe: a free function without state.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace tactus {

// The reason of an error of Tactus, e.g. "INVALID_CONFIG"; empty for others.
std::string ReasonOf(const absl::Status& status);

}  // namespace tactus
