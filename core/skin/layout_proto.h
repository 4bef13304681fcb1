// File: layout_proto.h
//
// SkinLayout as the wire's SensorGeometry and back.
//
// Thread-safe: free functions without state.
#pragma once

#include "absl/status/statusor.h"
#include "core/skin/layout.h"
#include "tactus/v1/common.pb.h"

namespace tactus::internal {

v1::SensorGeometry LayoutToProto(const SkinLayout& layout);

// The layout that `geometry` describes, or names: a preset, when rows and
// columns are 0; mask, thresholds, connectivity and light touch given with it
// replace the preset's. UNKNOWN_LAYOUT or INVALID_CONFIG otherwise.
absl::StatusOr<SkinLayout> LayoutFromProto(const v1::SensorGeometry& geometry);

}  // namespace tactus::internal
