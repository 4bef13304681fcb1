// File: simulate_contact.h
//
// Simulates one contact by the exact method: from a TrialSpec to the signals of
// an ideal skin.
//
//   TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
//                           SimulateContact(spec));
//   Trial trial = SignalTrial(contact, SignalNoise(), seed);
//
// Stateless; thread-safe: callers may simulate several specs in parallel. Same
// arguments, same bits.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/sim/exact/exact.h"
#include "core/sim/model/trial_spec.h"
#include "core/sim/skin/simulated_contact.h"

namespace tactus::internal {

struct SimulateOptions {
  // False: the area signal stays 0.
  bool area = true;
  ExactOptions exact;
};

// INVALID_SCENE for a bad spec or option, NUMERICAL_FAILURE if there are too
// many events.
absl::StatusOr<SimulatedContact> SimulateContact(
    const TrialSpec& spec, const SimulateOptions& options = {});

// The contact and, if its object moved, its twin with the object fixed.
absl::StatusOr<std::vector<SimulatedContact>> SimulateWithTwin(
    const TrialSpec& spec);

}  // namespace tactus::internal
