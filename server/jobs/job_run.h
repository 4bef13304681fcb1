// File: job_run.h
//
// JobRun: one job while it runs, in whatever process.
//
//   v1::JobEvent event;
//   while (run.Next(timeout, &event) != JobRun::News::kClosed) Use(event);
//   const JobRun::End end = run.Wait(patience);
//
// Not thread-safe.
#pragma once

#include <chrono>
#include <string>

#include "tactus/v1/storage.pb.h"

namespace tactus::internal::server {

class JobRun {
 public:
  struct End {
    // It did the job.
    bool ok = false;
    // Its exit status (server/trainer/exit_status.h); -1 without one.
    int status = -1;
    // How it ended, for people: "exited with status 3", "was ended by SIGKILL".
    std::string text;
  };
  // What Next found.
  enum class News { kEvent, kNone, kClosed };

  virtual ~JobRun() = default;

  // Waits for the next event, at most for `timeout`. kClosed if there will be
  // none.
  virtual News Next(std::chrono::milliseconds timeout, v1::JobEvent* event) = 0;
  // Asks it to end, or ends it at once.
  virtual void Terminate(bool kill) = 0;
  // Waits until it has ended; ends it if that takes longer than `patience`.
  virtual End Wait(std::chrono::milliseconds patience) = 0;
};

}  // namespace tactus::internal::server
