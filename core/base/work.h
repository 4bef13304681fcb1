// File: work.h
//
// What a caller lends to long computations. Core starts no thread and reads no
// clock, so it takes threads as a ParallelFor and reports its progress to a
// Progress.
//
//   Progress progress([](absl::string_view phase, double fraction) {
//     done[phase] += fraction;  // 1 in the end
//   });
//   FitModel(contacts, options, RunSerially, progress);
//
// A Progress is a small value. Copies report to the same function.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "absl/strings/string_view.h"

namespace tactus::internal {

// Calls body(0) .. body(count - 1), in any order, on any threads, and returns
// when all calls have returned.
using ParallelFor =
    std::function<void(int count, const std::function<void(int)>& body)>;

// Calls one body after another on the calling thread.
inline void RunSerially(int count, const std::function<void(int)>& body) {
  for (int i = 0; i < count; ++i) body(i);
}

class Progress {
 public:
  // Takes the phase of the work and the fraction of that phase which was done
  // since the last call. The calls may come from any thread, several at once.
  using Report = std::function<void(absl::string_view phase, double fraction)>;

  // Reports to nobody.
  Progress() = default;
  explicit Progress(Report report) : report_(std::move(report)) {}

  // The progress of a part that takes about `weight`, 0 to 1, of this work. A
  // part of the whole work becomes the phase `phase`, if that is not empty. A
  // part of a phase belongs to that phase.
  Progress Part(absl::string_view phase, double weight) const {
    Progress part = *this;
    if (phase_.empty()) {
      part.phase_ = std::string(phase);
    } else {
      part.weight_ *= weight;
    }
    return part;
  }

  // Reports that `fraction` more of this work is done.
  void Add(double fraction) const {
    if (report_ && !phase_.empty()) report_(phase_, weight_ * fraction);
  }

 private:
  Report report_;
  std::string phase_;
  double weight_ = 1;
};

}  // namespace tactus::internal
