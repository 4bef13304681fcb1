// File: fit_flags.h
//
// Flags that say how models are fitted; shared by fit and evaluate.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "core/train/fit.h"

namespace tactus::client {

struct FitFlags {
  std::string preset = "tuned";
  std::string features = "f,m,a";
  uint64_t seed = 1;
  int states = 0;
  int mixtures = 0;
  std::optional<int> networks;
  int epochs = 0;
  std::optional<int> stretches;
  bool no_estimates = false;
  std::string hmm_cues;
  std::string lstm_cues;

  void Add(CLI::App& command);
  // The name of a flag on the command line, like "--preset"; empty if there is
  // none.
  std::string FirstGiven() const;
  // The preset with what the other flags change.
  absl::StatusOr<FitOptions> Options() const;

 private:
  // Those that Add() made; the command owns them.
  std::vector<const CLI::Option*> options_;
};

}  // namespace tactus::client
