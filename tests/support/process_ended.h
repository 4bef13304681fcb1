// File: process_ended.h
//
// Whether a process that is no child of this one has ended.
//
//   EXPECT_TRUE(Eventually([&] { return ProcessEnded(pid); }));
#pragma once

#include <sys/types.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {

// True also for one that nobody has waited for.
inline bool ProcessEnded(pid_t process) {
  const std::string state = ReadBytes(absl::StrCat("/proc/", process, "/stat"));
  const size_t name = state.rfind(") ");
  return name == std::string::npos || state[name + 2] == 'Z';
}

}  // namespace tactus::internal
