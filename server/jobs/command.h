// File: command.h
//
// Runs a program to its end and takes what it prints.
//
//   const auto done = RunCommand({"scancel", "42"}, std::chrono::seconds(10));
//   if (!done.ok()) return done.status();
//   if (done->status != 0) return IoError("scancel", done->output);
//
// Thread-safe: a free function without state.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace tactus::internal::server {

struct CommandResult {
  // The exit status; -1 if a signal ended it.
  int status = -1;
  // It took longer than it may, and was killed.
  bool late = false;
  // Standard output and standard error, at most 64 KiB of both.
  std::string output;
};

// Finds the program as a shell does. It reads nothing, and is killed if it
// takes longer than `patience`. IO if it cannot be started.
absl::StatusOr<CommandResult> RunCommand(const std::vector<std::string>& words,
                                         std::chrono::milliseconds patience);

}  // namespace tactus::internal::server
