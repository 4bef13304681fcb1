// File: reproduce_data.h
//
// Simulates the paper's two experiments as labelled contacts.
//
//   TACTUS_ASSIGN_OR_RETURN(LoadedContacts data,
//                           SimulateExperiment(Experiment::kSimulation, 1,
//                                              "relative", Progress()));
//
// Uses all processors. The same experiment and seed give the same bits.
// Thread-safe.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "core/eval/paper_tables.h"
#include "tools/trainctl/command.h"

namespace tactus::internal::client {

// Simulates one experiment and reports to `progress`.
//
// kSimulation: the 1,835 trials with ideal signals of 5 s. kCody: the 240
// trials of 1.2 s with the frames of the skin `good`, through the feature path.
//
// `noise` is the reading of the noise of ideal signals (ParseNoiseReading), or
// empty for the default; a skin has its own.
absl::StatusOr<LoadedContacts> SimulateExperiment(Experiment experiment,
                                                  uint64_t seed,
                                                  const std::string& noise,
                                                  const Progress& progress);

}  // namespace tactus::internal::client
