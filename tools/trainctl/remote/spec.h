// File: spec.h
//
// How a server is to fit models, from the flags of `train` and `evaluate`.
//
//   TACTUS_ASSIGN_OR_RETURN(v1::TrainSpec spec, TrainSpecOf(flags));
//
// Thread-safe: a free function without state.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "tactus/v1/operations.pb.h"

namespace tactus::client {

// As users write them; what is empty is the preset's or the server's.
struct SpecFlags {
  std::string preset;
  std::string features;  // "f,m"
  std::string truth;     // "final" or "so-far"
  std::string shares;    // "recorded" or "even"
  uint64_t seed = 1;
  std::optional<uint32_t> networks;
  std::optional<uint32_t> epochs;
  std::optional<uint32_t> hmms_per_class;
  std::optional<uint32_t> choice_work;
  std::string with_cues;     // "force_pitch_short,force_pitch_long"
  std::string without_cues;  // "log_drag"
};

// The spec, without its dataset and model. INVALID_CONFIG, with the exit code
// of wrong usage, for words that are not those above. The server checks the
// rest.
absl::StatusOr<v1::TrainSpec> TrainSpecOf(const SpecFlags& flags);

}  // namespace tactus::client
