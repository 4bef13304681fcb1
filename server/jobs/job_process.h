// File: job_process.h
//
// JobProcess: the process that does one job, with lower priority and limited
// memory, so that it cannot disturb the streams.
//
//   TACTUS_ASSIGN_OR_RETURN(auto process, JobProcess::Start(options, folder));
//   v1::JobEvent event;
//   while (process->Next(timeout, &event) != JobProcess::News::kClosed) Use();
//   const JobProcess::End end = process->Wait(patience);
//
// The process ends when this one does. Not thread-safe, except Terminate. The
// thread that calls Start must live as long as the process.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal::server {

class JobProcess {
 public:
  struct Options {
    // Path of the program tactus-trainer.
    std::string program = {};
    // What starts it, with arguments: mpirun for several ranks. Empty: nothing.
    std::vector<std::string> launcher = {};
    // Memory that it may have; 0 for no limit.
    int64_t memory_bytes = 0;
    // Processors that it uses at once, at least 1: until the first iteration,
    // and then.
    int start_threads = 1;
    int threads = 1;
  };
  struct End {
    // It exited with status 0.
    bool ok = false;
    // Its exit status; -1 if a signal ended it.
    int status = -1;
    // How it ended, for people: "exited with status 3", "was ended by SIGKILL".
    std::string text;
  };

  // Runs `launcher program folder start_threads threads`. Its standard error
  // goes to the file "log" in `folder`. IO.
  static absl::StatusOr<std::unique_ptr<JobProcess>> Start(
      const Options& options, const std::string& folder);
  // Kills it if it still runs.
  ~JobProcess();

  // What Next found.
  enum class News { kEvent, kNone, kClosed };
  // Waits for the next event, at most for `timeout`. kClosed if there will be
  // none: the process has closed its output, or it wrote something else and was
  // killed for that.
  News Next(std::chrono::milliseconds timeout, v1::JobEvent* event);

  // Asks it to end (SIGTERM), or kills it (SIGKILL).
  void Terminate(bool kill);
  // Waits until it has ended; kills it if that takes longer than `patience`.
  End Wait(std::chrono::milliseconds patience);

 private:
  JobProcess(pid_t pid, int output) : pid_(pid), output_(output) {}
  // What Next returns when the process wrote no events.
  News Garbage();

  pid_t pid_;
  int output_;
  // Bytes of an event that is not complete.
  std::string buffer_;
};

}  // namespace tactus::internal::server
