// File: json.h
//
// The one place where programs write JSON. Writing cannot throw: text that is
// not UTF-8 is written with the replacement character U+FFFD, and numbers that
// are not finite as null.
//
//   Json json = {{"trials", 3}, {"label", label}};
//   std::cout << JsonText(json) << "\n";
//
// Thread-safe: free functions without state.
#pragma once

#include <string>

#include "nlohmann/json.hpp"

namespace tactus::internal::client {

// Objects keep the order in which keys were set.
using Json = nlohmann::ordered_json;

// One line; with `indent` above 0, one line per value.
inline std::string JsonText(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', /*ensure_ascii=*/false,
                   Json::error_handler_t::replace);
}

}  // namespace tactus::internal::client
