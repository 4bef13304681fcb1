// File: fit_flags.h
//
// Flags that say how models are fitted; shared by fit and evaluate.
#pragma once

#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "core/eval/fit.h"

namespace tactus::client {

struct FitFlags {
  std::string preset = "tuned";
  std::string features = "f,m,a";
  uint64_t seed = 1;
  int states = 0;
  int mixtures = 0;
  int networks = -1;
  int epochs = 0;
  int stretches = -1;
  bool no_estimates = false;
  std::string hmm_cues;
  std::string lstm_cues;

  void Add(CLI::App& command);
  // The preset with what the other flags change.
  absl::StatusOr<FitOptions> Options() const;
};

}  // namespace tactus::client
