// File: import_all.h
//
// The trials of a source as a list.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "core/import/import.h"
#include "gtest/gtest.h"

namespace tactus::internal {

inline absl::StatusOr<std::vector<Trial>> ImportAll(
    const std::string& path, const ImportOptions& options = {}) {
  std::vector<Trial> trials;
  auto count = ImportTrials(
      path,
      [&](Trial trial) {
        trials.push_back(std::move(trial));
        return absl::OkStatus();
      },
      options);
  if (!count.ok()) return count.status();
  EXPECT_EQ(*count, trials.size());
  return trials;
}

}  // namespace tactus::internal
