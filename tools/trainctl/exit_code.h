// File: exit_code.h
//
// The exit codes of trainctl, carried by the status of a command.
//
//   return WithExitCode(status, kExitJobFailed);
//
// Thread-safe: free functions without state.
#pragma once

#include "absl/status/status.h"

namespace tactus::internal::client {

enum ExitCode {
  kExitOk = 0,
  // Anything that has no other code.
  kExitError = 1,
  // `doctor`: checks with warnings, and none with errors.
  kExitDoctorWarnings = 1,
  // The command line is wrong.
  kExitUsage = 2,
  // `doctor`: checks with errors.
  kExitDoctorErrors = 2,
  // The server ran the job, and it failed.
  kExitJobFailed = 3,
  kExitJobCancelled = 4,
  // A promotion's candidate is worse than what it was to replace.
  kExitGateNotPassed = 5,
  // The user ended a watch; the job goes on. As shells count SIGINT.
  kExitInterrupted = 130,
};

// `status`, an error, with the exit code that it leads to.
absl::Status WithExitCode(absl::Status status, ExitCode code);

// The exit code of a status: kExitOk; the one given; kExitUsage if the status
// is about a flag, so that its message begins with "--"; else kExitError.
ExitCode ExitCodeOf(const absl::Status& status);

}  // namespace tactus::internal::client
