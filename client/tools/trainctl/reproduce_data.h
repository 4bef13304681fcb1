// File: reproduce_data.h
//
// The paper's two experiments as labelled contacts, simulated on the spot.
//
//   TACTUS_ASSIGN_OR_RETURN(LoadedContacts data,
//                           SimulateExperiment(Experiment::kSimulation, 1,
//                                              Progress()));
//
// Uses all processors; same experiment and seed, same bits. Thread-safe.
#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "client/tools/trainctl/command.h"
#include "core/eval/paper_tables.h"

namespace tactus::client {

// kSimulation: the 1,835 trials with ideal signals of 5 s. kCody: the 240
// trials of 1.2 s with taxel frames, through the feature path.
absl::StatusOr<LoadedContacts> SimulateExperiment(Experiment experiment,
                                                  uint64_t seed,
                                                  const Progress& progress);

}  // namespace tactus::client
