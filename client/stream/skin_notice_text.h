// File: skin_notice_text.h
//
// What people read of a notice that a skin reads unlike any recording of
// training.
//
//   if (notice.kind() == v1::StreamNotice::KIND_SKIN_DIFFERS) {
//     Print(SkinNoticeText(notice));
//   }
//
// Thread-safe: a free function without state.
#pragma once

#include <string>

#include "tactus/v1/contact.pb.h"

namespace tactus::internal::client {

// One line.
std::string SkinNoticeText(const v1::StreamNotice& notice);

}  // namespace tactus::internal::client
