// File: job_display.h
//
// JobDisplay: shows on stderr how far a job of a server is. On a terminal it
// rewrites one line: bar, phase, times, the learning curve and its last value.
// Into a pipe or a file it writes one line per state and per finished part.
//
//   JobDisplay display;
//   watcher.Watch(name, [&](const v1::Operation& now, auto points) {
//     display.Update(now, points);
//   });
//   display.Clear();
//
// Not thread-safe.
#pragma once

#include <functional>
#include <ostream>
#include <span>
#include <string>

#include "tactus/v1/operations.pb.h"
#include "tools/trainctl/fit/learning_curves.h"
#include "tools/trainctl/progress_display.h"

namespace tactus::internal::client {

class JobDisplay {
 public:
  JobDisplay();
  // For tests, as ProgressDisplay.
  JobDisplay(std::ostream& out, bool terminal, std::function<double()> seconds);

  // `points` are those since the update before.
  void Update(const v1::Operation& operation,
              std::span<const v1::LearningPoint> points);
  // Removes the line from the terminal.
  void Clear();

 private:
  void Take(const v1::LearningPoint& point);
  void WriteLine(const std::string& text);

  std::ostream& out_;
  const bool terminal_;
  ProgressDisplay display_;
  LearningCurves curves_;
  v1::Operation::State state_ = v1::Operation::STATE_UNSPECIFIED;
};

}  // namespace tactus::internal::client
