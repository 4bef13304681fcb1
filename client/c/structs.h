// File: structs.h
//
// The structs of tactus.h and those of the C++ interface. The caller's struct
// may be shorter than ours, if the caller was compiled with an older header.
//
//   TACTUS_ASSIGN_OR_RETURN(const Skin skin, SkinFromC(*given));
//   CopyOut(full, event);
//   CopyText(status.message(), error->text);
//
// Thread-safe: free functions without state. A struct that is longer than ours
// is INVALID_CONFIG: its library is a newer one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/c/include/tactus.h"
#include "tactus/answer.h"
#include "tactus/skin.h"
#include "tactus/stream.h"

namespace tactus::internal::c {

absl::StatusOr<Skin> SkinFromC(const tactus_skin& given);
absl::StatusOr<StreamOptions> OptionsFromC(const tactus_options& given);
// `given.values` has `given.count` values.
absl::Status FrameFromC(const tactus_frame& given, Frame& frame);

// An answer is read in C by its address alone.
inline const tactus_answer* ToC(const Answer* answer) {
  return reinterpret_cast<const tactus_answer*>(answer);
}

// Writes what the caller's struct has room for.
template <typename Struct>
void CopyOut(Struct full, Struct* out) {
  full.struct_size = out->struct_size;
  std::memcpy(out, &full, std::min(out->struct_size, sizeof(Struct)));
}

// Cuts between two characters of UTF-8.
template <size_t kSize>
void CopyText(absl::string_view text, char (&out)[kSize]) {
  size_t size = std::min(text.size(), kSize - 1);
  while (size > 0 && size < text.size() &&
         (static_cast<unsigned char>(text[size]) & 0xC0) == 0x80) {
    --size;
  }
  std::memcpy(out, text.data(), size);
  out[size] = 0;
}

}  // namespace tactus::internal::c
