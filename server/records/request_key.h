// File: request_key.h
//
// The key under which the catalogue remembers a request, so that a repeated
// request finds what the first one made. A client chooses its request ids, so
// the key has the client's name: no client meets another one's requests.
//
//   change.Put(Table::kRequests, RequestKey("operation", caller, id), key);
//
// Thread-safe: a free function without state.
#pragma once

#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "server/records/caller.h"

namespace tactus::internal::server {

// `kind`: what the request makes. Different names, kinds or ids give different
// keys.
inline std::string RequestKey(absl::string_view kind, const Caller& caller,
                              absl::string_view request_id) {
  return absl::StrCat(kind, "/", caller.name.size(), ":", caller.name, "/",
                      request_id);
}

}  // namespace tactus::internal::server
