// File: idle.h
//
// How long the first frame after a silence waits for its answer: on an idle
// server that is the moment a touch begins.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace tactus::client {

struct IdleOptions {
  // Empty: a server of our own.
  std::string server;
  int repetitions = 100;
  int silence_ms = 3000;
};

// Milliseconds from sending a frame to its posterior, one a repetition.
absl::StatusOr<std::vector<double>> MeasureIdle(const IdleOptions& options);

}  // namespace tactus::client
