// File: skin_convert.h
//
// The public Skin and Frame (tactus/skin.h) as the SkinInfo and SkinFrame that
// streams and drivers use, and back.
//
//   TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, ToSkinInfo(skin));
//   SkinFrame out;
//   TACTUS_RETURN_IF_ERROR(ToSkinFrame(frame, info, out));
//
// Frames keep their memory: nothing allocates after the first. Thread-safe:
// free functions without state.
#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/stream/skin_frame.h"
#include "tactus/skin.h"

namespace tactus::internal::client {

// INVALID_CONFIG or UNKNOWN_LAYOUT naming the field that is wrong.
absl::StatusOr<SkinInfo> ToSkinInfo(const Skin& skin);
Skin ToSkin(const SkinInfo& info);

// INVALID_CONFIG if the values are not as many as the skin has, or not whole
// numbers of two bytes though its encoding says so.
absl::Status ToSkinFrame(const Frame& frame, const SkinInfo& info,
                         SkinFrame& out);
void ToFrame(const SkinFrame& frame, const SkinInfo& info, Frame& out);

}  // namespace tactus::internal::client
