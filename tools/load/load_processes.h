// File: load_processes.h
//
// LoadProcesses: a load test by several processes, because one process sends
// from one thread. Each simulates a part of the robots; what they counted is
// added, delay by delay.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto processes,
//                           LoadProcesses::Start("/proc/self/exe", flags, 4));
//   TACTUS_ASSIGN_OR_RETURN(const LoadReport report, processes->Run(2000));
//
// A process is `program` with `flags` and --part, and serves one test after
// another (ServeLoadParts). They end with this object, or if this process dies.
// Not thread-safe.
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "tools/load/load.h"

namespace tactus::internal::client {

class LoadProcesses {
 public:
  static absl::StatusOr<std::unique_ptr<LoadProcesses>> Start(
      const std::string& program, const std::vector<std::string>& flags,
      int count);
  ~LoadProcesses();

  LoadProcesses(const LoadProcesses&) = delete;
  LoadProcesses& operator=(const LoadProcesses&) = delete;

  // One test of so many robots. IO if a process ended; do not use it again.
  absl::StatusOr<LoadReport> Run(int robots);

 private:
  struct Process;

  LoadProcesses() = default;

  absl::Status Tell(const std::string& line);

  std::vector<std::unique_ptr<Process>> processes_;
};

// What a process of LoadProcesses does: reads from standard input what to run,
// and writes to standard output what it counted. Returns when the input ends.
absl::Status ServeLoadParts(LoadOptions options);

}  // namespace tactus::internal::client
