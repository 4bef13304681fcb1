// File: paging.h
//
// Pages of a list. A page token is the key of the last entry before the page.
//
//   TACTUS_ASSIGN_OR_RETURN(int size, PageSize(request.page_size()));
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/errors.h"

namespace tactus::internal::server {

// One page of a list and the token of the next one.
template <typename Item>
struct Page {
  std::vector<Item> items;
  // Empty after the last page.
  std::string next_token;
};

// 0 means 100; more than 1,000 means 1,000. INVALID_CONFIG if negative.
inline absl::StatusOr<int> PageSize(int32_t wanted) {
  constexpr int kDefault = 100;
  constexpr int kMax = 1'000;
  if (wanted < 0) return InvalidConfig("page_size", wanted, "0 to 1000");
  if (wanted == 0) return kDefault;
  return wanted < kMax ? wanted : kMax;
}

}  // namespace tactus::internal::server
