// File: event_writer.h
//
// EventWriter: sends a job's progress and learning curve to the server, as
// JobEvents on a descriptor.
//
//   EventWriter events(STDOUT_FILENO);
//   FitModel(contacts, options, parallel, events.progress(), &journal);
//
// A server that is gone ends the process by SIGPIPE. Thread-safe.
#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <string>

#include "core/base/work.h"
#include "core/train/fit_journal.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal::server {

class EventWriter {
 public:
  explicit EventWriter(int descriptor) : descriptor_(descriptor) {}

  // Sends the progress of phases, at most ten times a second.
  Progress progress();
  void Send(const LearningPoint& point);

 private:
  void Add(absl::string_view phase, double fraction);
  // With the lock.
  void Write(const v1::JobEvent& event);

  const int descriptor_;
  std::mutex mutex_;
  // Fraction of each phase that is done.
  std::map<std::string, double, std::less<>> done_;
  std::string phase_;
  std::chrono::steady_clock::time_point sent_ = {};
};

}  // namespace tactus::internal::server
