// File: trial_layout.h
//
// The skin of recorded trials. A trial carries its skin; those of older files
// and of other programs may carry the name of its layout class alone. If that
// is no preset, a JSON file describes the skin (docs/formats.md).
//
//   TACTUS_ASSIGN_OR_RETURN(SkinLayout given, ReadLayoutFile("palm.json"));
//   TACTUS_ASSIGN_OR_RETURN(SkinLayout skin, LayoutOfTrial(trial, &given));
//
// Thread-safe: free functions without state.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/data/trial.h"
#include "core/skin/layout.h"

namespace tactus::internal {

// Reads a tactus.v1.SensorGeometry in JSON. IO if the file cannot be read;
// INVALID_CONFIG or UNKNOWN_LAYOUT for its contents.
absl::StatusOr<SkinLayout> ReadLayoutFile(const std::string& path);

// The skin of a trial with taxels: the trial's own; else `layout` (null: none)
// if its name is the trial's layout class, else the preset of that name.
// INVALID_CONFIG if `layout` has the name of the trial's own skin and is
// another, or if the taxels have another shape or unit; UNKNOWN_LAYOUT if there
// is no such preset.
absl::StatusOr<SkinLayout> LayoutOfTrial(const Trial& trial,
                                         const SkinLayout* layout = nullptr);

}  // namespace tactus::internal
