// File: fit_flags.h
//
// FitFlags: the flags that decide how models are fitted, for fit and evaluate.
//
//   FitFlags flags;
//   flags.Add(*command);
//   TACTUS_ASSIGN_OR_RETURN(const ChosenOptions chosen,
//                           flags.Choose(loaded, display.progress()));
//
// The command line writes to the FitFlags, which must not move after Add(). Not
// thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/eval/chosen_options.h"
#include "core/train/fit.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/fit/spec_flags.h"
#include "tools/trainctl/progress_display.h"

namespace tactus::internal::client {

struct FitFlags {
  SpecFlags spec;
  // Those that a server does not know.
  int states = 0;
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
  absl::StatusOr<FitOptions> Options(absl::string_view preset) const;
  // The contacts of trials, with what models of these flags can use of them.
  absl::StatusOr<LoadedContacts> Load(const TrialSource& source,
                                      const Progress& progress) const;
  // The options for these contacts, which the result points to. `protocol`: how
  // they will be evaluated, if they will.
  // Each candidate of a choice becomes a line on standard error.
  absl::StatusOr<ChosenOptions> Choose(
      const LoadedContacts& loaded, ProgressDisplay& display,
      const std::optional<Protocol>& protocol = {}) const;

 private:
  OptionsRequest Request(bool without_poses) const;

  // Those that Add() made; the command owns them.
  std::vector<const CLI::Option*> options_;
};

}  // namespace tactus::internal::client
