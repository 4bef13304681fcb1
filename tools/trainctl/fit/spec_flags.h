// File: spec_flags.h
//
// SpecFlags: the flags of a TrainSpec, which say how models are to be fitted,
// here or by a server.
//
//   SpecFlags flags;
//   flags.Add(*command);
//   TACTUS_ASSIGN_OR_RETURN(v1::TrainSpec spec, TrainSpecOf(flags));
//
// The command line writes to the SpecFlags, which must not move after Add().
// Not thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "tactus/v1/operations.pb.h"

namespace tactus::internal::client {

// As users write them; what is empty is the preset's or the server's.
struct SpecFlags {
  std::string preset;
  std::string features;  // "f,m"
  std::string truth;     // "final" or "so-far"
  std::string shares;    // "recorded" or "even"
  uint64_t seed = 1;
  std::optional<int> networks;
  std::optional<int> epochs;
  std::optional<int> gradient_shards = {};
  std::optional<int> hmms_per_class;
  std::optional<int> choice_work;
  std::string with_cues;       // "force_pitch_short,force_pitch_long"
  std::string without_cues;    // "log_drag"
  std::string questions = {};  // path of a label table

  // Returns the options that it adds; the command owns them.
  std::vector<const CLI::Option*> Add(CLI::App& command);
};

// The spec, without its dataset and model, with the text of the label table.
// INVALID_CONFIG, with the exit code of wrong usage, for words that are not
// those above and for numbers out of range; IO or INVALID_CONFIG for the label
// table. ApplySpec and the server check the rest.
absl::StatusOr<v1::TrainSpec> TrainSpecOf(const SpecFlags& flags);

}  // namespace tactus::internal::client
