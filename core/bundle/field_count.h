// File: field_count.h
//
// Counts the fields of a serialised message without parsing it: an empty nested
// message takes two bytes in a file and a hundred in memory, so a small file
// may ask for more memory than there is.
//
//   if (!HasAtMostFields(*v1::ModelBundle::descriptor(), bytes, 1000)) return;
//
// Thread-safe: a free function without state. It allocates nothing.
#pragma once

#include "absl/strings/string_view.h"
#include "google/protobuf/descriptor.h"

namespace tactus::internal {

// True if `bytes` is the encoding of a message of type `type` with at most
// `limit` fields: those of nested messages and fields that `type` does not know
// count too, a packed list counts as one. False also for a wrong encoding.
bool HasAtMostFields(const google::protobuf::Descriptor& type,
                     absl::string_view bytes, int limit);

}  // namespace tactus::internal
