// File: fit_flags.h
//
// FitFlags: the flags that decide how models are fitted, for fit and evaluate.
//
//   FitFlags flags;
//   flags.Add(*command);
//   TACTUS_ASSIGN_OR_RETURN(FitOptions options, flags.Options("tuned"));
//
// The command line writes to the FitFlags, which must not move after Add(). Not
// thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "core/train/fit.h"

namespace tactus::client {

struct FitFlags {
  // Empty: as chosen_preset.h says.
  std::string preset;
  std::string features = "f,m,a";
  std::string truth;  // empty: the preset's
  uint64_t seed = 1;
  int states = 0;
  int mixtures = 0;
  std::optional<int> networks;
  int epochs = 0;
  std::optional<int> stretches;
  bool no_estimates = false;
  bool skip_unusable = false;
  std::string hmm_cues;
  std::string lstm_cues;

  void Add(CLI::App& command);
  // Returns the first of these flags that was given, like "--preset"; empty if
  // none was.
  std::string FirstGiven() const;
  // Returns the options of a preset, changed as the other flags say.
  absl::StatusOr<FitOptions> Options(const std::string& preset) const;
  // With --skip-unusable, removes the contacts that models cannot be fitted to
  // (usable.h), and returns their ids.
  std::vector<std::string> SkipUnusable(
      const FitOptions& options,
      std::vector<const LabelledContact*>& contacts) const;

 private:
  // Those that Add() made; the command owns them.
  std::vector<const CLI::Option*> options_;
};

}  // namespace tactus::client
