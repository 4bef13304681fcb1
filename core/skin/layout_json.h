// File: layout_json.h
//
// SkinLayout as text: a tactus.v1.SensorGeometry in protobuf's JSON form
// (docs/formats.md, "Layouts in JSON"). Layout files and trial files hold it.
//
//   const std::string text = LayoutToJson(layout);
//   TACTUS_ASSIGN_OR_RETURN(SkinLayout again, LayoutFromJson(text));
//
// Numbers come back with the same bits. Thread-safe: free functions without
// state.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/skin/layout.h"

namespace tactus::internal {

// One line.
std::string LayoutToJson(const SkinLayout& layout);

// The layout that `json` describes in full, or the preset that it names,
// refined by what else it holds. INVALID_CONFIG or UNKNOWN_LAYOUT otherwise.
absl::StatusOr<SkinLayout> LayoutFromJson(absl::string_view json);

}  // namespace tactus::internal
