// File: simulated_contact.h
//
// SimulatedContact: the signals that an ideal skin reads from one simulated
// contact, and what happened in it. Becomes a Trial with these signals
// (SignalTrial) or with taxel frames (record_contact.h).
//
//   TACTUS_ASSIGN_OR_RETURN(auto contact, SimulateContact(spec));
//   Trial trial = SignalTrial(contact, SignalNoise(), seed);
//
// Plain data and functions without state; thread-safe. Same arguments, same
// bits.
#pragma once

#include <cstdint>
#include <string>

#include "core/data/trial.h"
#include "core/sim/model/trajectory.h"
#include "core/sim/model/trial_spec.h"
#include "core/sim/skin/signals.h"

namespace tactus::internal {

struct SimulatedContact {
  TrialSpec spec;
  IdealSignals signals;
  bool moved = false;
  EventCounts events;
  // Bounces that were not solved one by one (core/sim/exact/bounce_ride.h).
  int64_t skipped_bounces = 0;

  bool hard() const { return spec.object.Stiffness() >= kHardStiffness; }
  // "HU", "HM", "SU" or "SM".
  std::string Label() const;
  // Number, label, condition, object and so on, without signals or taxels.
  Trial Metadata() const;
};

// The trial with its three signals and their noise, which is drawn from `seed`
// and the trial's number.
Trial SignalTrial(const SimulatedContact& contact, const SignalNoise& noise,
                  uint64_t seed);

}  // namespace tactus::internal
