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
#include "server/jobs/event_bytes.h"
#include "server/jobs/job_run.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal::server {

class JobProcess final : public JobRun {
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
  // Runs `launcher program folder start_threads threads`. Its standard error
  // goes to the file "log" in `folder`. IO.
  static absl::StatusOr<std::unique_ptr<JobProcess>> Start(
      const Options& options, const std::string& folder);
  // Kills it if it still runs.
  ~JobProcess() override;

  // kClosed if the process has closed its output, or if it wrote something else
  // and was killed for that.
  News Next(std::chrono::milliseconds timeout, v1::JobEvent* event) override;
  // By SIGTERM or SIGKILL.
  void Terminate(bool kill) override;
  End Wait(std::chrono::milliseconds patience) override;

 private:
  JobProcess(pid_t pid, int output) : pid_(pid), output_(output) {}
  // What Next returns when the process wrote no events.
  News Garbage();

  pid_t pid_;
  int output_;
  EventBytes bytes_;
};

}  // namespace tactus::internal::server
