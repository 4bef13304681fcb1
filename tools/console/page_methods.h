// File: page_methods.h
//
// The methods of servers that pages may call, and no others. One of them is
// gRPC's own health check.
//
//   const auto target =
//       FindPageMethod("/api/servers/0/ModelService/ListAliases");
//   if (target) Call(target->server, target->method->FullName());
//
// A method that is here does only what the server lets the person do: the
// server knows the roles, the console has none. Thread-safe: free functions
// without state.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"

namespace tactus::internal::console {

// How many messages a server sends.
enum class PageAnswer {
  // One, which is the response.
  kOne,
  // Some, and then it ends: {"messages": [...]}.
  kAll,
  // More and more; the call ends after the first one, which is the response.
  kFirst,
};

struct PageMethod {
  absl::string_view service;
  absl::string_view name;
  PageAnswer answer = PageAnswer::kOne;
  absl::string_view package = "tactus.v1";

  // Like "tactus.v1.ModelService.ListAliases".
  std::string FullName() const;
  // Like "/tactus.v1.ModelService/ListAliases".
  std::string Path() const;
};

struct PageTarget {
  size_t server = 0;
  const PageMethod* method = nullptr;
};

const std::vector<PageMethod>& PageMethods();

// True if a path of a request is one of these, with a method that exists or
// not.
bool IsPageCall(absl::string_view path);

// None if there is no such method, or no number of a server.
std::optional<PageTarget> FindPageMethod(absl::string_view path);

}  // namespace tactus::internal::console
