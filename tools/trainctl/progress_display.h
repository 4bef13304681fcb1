// File: progress_display.h
//
// ProgressDisplay: shows on stderr how far a command is. On a terminal it
// rewrites one line: phase, a bar, time left, a curve. Into a pipe or a file it
// writes one line per phase. It shows nothing in the first second, so short
// commands stay quiet, and it never writes to stdout.
//
//   ProgressDisplay display;
//   FitModel(contacts, options, RunOnThreads, display.progress());
//   display.Clear();  // before printing to the terminal
//
// A Progress refers to its display, which must outlive it. Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <ostream>
#include <string>

#include "absl/strings/string_view.h"
#include "core/base/work.h"

namespace tactus::internal::client {

// With `hide`, displays that are made from now on show nothing, so that stderr
// has remarks and errors alone. Call it before threads begin.
void HideProgress(bool hide);

// "[####      ]  41 %".
std::string ProgressBar(double fraction);

class ProgressDisplay {
 public:
  // Shows progress on stderr.
  ProgressDisplay();
  // For tests: `seconds` returns the time since the command started. `out`
  // must outlive the display.
  ProgressDisplay(std::ostream& out, bool terminal,
                  std::function<double()> seconds);
  ~ProgressDisplay() { Clear(); }

  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  // The progress that this display shows.
  Progress progress();

  // Shows that `count` things of a phase are done, of an unknown number.
  void Count(absl::string_view phase, int64_t count);

  // Shows `detail` about a phase, on a terminal; else only the phase.
  void Report(absl::string_view phase, absl::string_view detail);

  // Shows `curve`, e.g. LearningCurves::Text(), behind the present phase, on a
  // terminal.
  void Curve(const std::string& curve);
  bool terminal() const { return terminal_; }

  // Removes the line from the terminal; the next report writes it again.
  void Clear();

 private:
  void Add(absl::string_view phase, double fraction);
  // Shows the present phase.
  void ShowFraction();
  // Starts another phase if `phase` is not the present one.
  void Enter(absl::string_view phase);
  // Shows the phase, with `detail` on a terminal.
  void Show(const std::string& detail);

  std::ostream& out_;
  const bool terminal_;
  const std::function<double()> seconds_;
  const bool hidden_;

  std::mutex mutex_;
  std::string phase_;
  double phase_start_ = 0;
  double fraction_ = 0;
  std::string curve_;
  // Whether the present phase has its line, if there is no terminal.
  bool announced_ = false;
  // Time and width of the last line on the terminal; 0 without one.
  double shown_at_ = 0;
  size_t shown_width_ = 0;
};

}  // namespace tactus::internal::client
