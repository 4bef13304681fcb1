// File: child_program.h
//
// RunChild: runs another program to its end, within limits. What it does wrong,
// this process survives.
//
//   std::atomic<bool> cancelled = false;
//   TACTUS_ASSIGN_OR_RETURN(
//       const ChildEnd end,
//       RunChild({.program = "/usr/bin/sort", .arguments = {"-r", "names"},
//                 .folder = "/srv/lists", .patience = std::chrono::seconds(9)},
//                cancelled));
//   if (end.status == 0) Show(end.out);
//
// Blocks. Thread-safe. The program and all processes that it starts end with
// the call, and the program also with this process.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace tactus::internal::console {

struct ChildOptions {
  std::string program;
  // Behind the program's name. Other users of the host can read them.
  std::vector<std::string> arguments = {};
  // Where it works.
  std::string folder = {};
  // Its standard input. It stays in memory, so secrets may be in it.
  std::string input = {};
  // Address space, a file that it writes, and what is kept of either output; 0
  // bytes of memory for no limit.
  int64_t memory_bytes = 0;
  int64_t file_bytes = 1024L * 1024;
  size_t text_bytes = 64 * 1024;
  std::chrono::milliseconds patience{60'000};
};

struct ChildEnd {
  // The exit status; -1 if a signal ended it.
  int status = -1;
  // The signal; 0 if it exited.
  int signal = 0;
  // It took longer than the patience, or was cancelled; then it was killed.
  bool took_too_long = false;
  bool was_cancelled = false;
  // The standard output and the standard error, as far as they are kept.
  std::string out;
  std::string err;
};

// Runs a program with the environment of this process, except variables that
// begin with TACTUS: they would add flags. Setting `cancelled` ends it. IO if
// it cannot be started.
absl::StatusOr<ChildEnd> RunChild(const ChildOptions& options,
                                  const std::atomic<bool>& cancelled);

}  // namespace tactus::internal::console
