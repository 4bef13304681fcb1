// File: bag_files.h
//
// The two storages of bags of ROS 2: MCAP, and SQLite 3.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto file, OpenMcapBag("run1_0.mcap"));
//   BagMessage message;
//   const BagTopic* topic = nullptr;
//   TACTUS_ASSIGN_OR_RETURN(const bool more, file->Next(&message, &topic));
//
// Thread-safe: free functions without state.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "core/import/ros2/ros2_bag.h"

namespace tactus::internal {

// IO or TRIAL_FILE_INVALID with the file.
absl::StatusOr<std::unique_ptr<BagFile>> OpenMcapBag(const std::string& path);
absl::StatusOr<std::unique_ptr<BagFile>> OpenSqliteBag(const std::string& path);

}  // namespace tactus::internal
