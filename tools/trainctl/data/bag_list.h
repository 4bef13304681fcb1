// File: bag_list.h
//
// Prints what a bag of ROS 2 holds, and a skin.json to start from.
//
//   TACTUS_RETURN_IF_ERROR(ListBag("run1", /*json=*/false));
//
// Thread-safe: a free function without state.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace tactus::internal::client {

// On stdout, with `json` as one object. The errors of SummarizeBag().
absl::Status ListBag(const std::string& path, bool json);

}  // namespace tactus::internal::client
