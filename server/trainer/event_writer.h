// File: event_writer.h
//
// EventWriter: sends a job's progress and learning curve to the server, as
// JobEvents on a descriptor. Of several ranks only the first one writes; the
// others tell it.
//
//   EventWriter events(STDOUT_FILENO, &team);
//   FitModel(contacts, options, parallel, events.progress(), &journal);
//
// A server that is gone ends the process by SIGPIPE. Thread-safe. The team must
// outlive it.
#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "core/base/work.h"
#include "core/train/fit_journal.h"
#include "server/trainer/team.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal::server {

class EventWriter {
 public:
  EventWriter(int descriptor, Team* team);

  // Sends the progress of phases, at most ten times a second.
  Progress progress();
  // The progress of work that every rank does, which the first one reports.
  Progress common_progress() {
    return team_->rank() == 0 ? progress() : Progress();
  }
  void Send(const LearningPoint& point);

 private:
  void Add(absl::string_view phase, double fraction);
  // Writes what was held back, and what the other ranks have told.
  void CatchUp();
  // What the other ranks have told.
  void Hear();
  void Take(int rank, const std::string& bytes);
  // The following with the lock.
  void SetDone(absl::string_view phase, int rank, double done);
  void WriteProgress();
  void Write(const v1::JobEvent& event);

  const int descriptor_;
  Team* const team_;
  std::mutex mutex_;
  // Fraction of each phase that each rank has done.
  std::map<std::string, std::vector<double>, std::less<>> done_;
  std::string phase_;
  // Its fraction, of all ranks, and whether that was written.
  double fraction_ = 0;
  bool written_ = true;
  std::chrono::steady_clock::time_point sent_ = {};
};

}  // namespace tactus::internal::server
