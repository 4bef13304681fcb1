// File: skin_notice.h
//
// The notice that a skin reads unlike any recording of training.
//
//   if (watch.EndContact()) WriteSkinNotice(range, watch, sink->AddNotice());
//
// Thread-safe: a free function without state.
#pragma once

#include "core/taxels/skin_range.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal {

void WriteSkinNotice(const SkinRange& range, const SkinRangeWatch& watch,
                     v1::StreamNotice* notice);

}  // namespace tactus::internal
