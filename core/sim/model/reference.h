// File: reference.h
//
// A second, slow way through the contact model, to check the exact one
// (exact.h) against: long double throughout, every phase stepped with its
// matrix exponential at a small part of the ringing's period, events looked
// for in every step. Shares no code with the exact method beyond the scene.
//
//   TACTUS_ASSIGN_OR_RETURN(Trajectory run, IntegrateReference(scene, 2000));
//
// Takes up to seconds a contact. Same scene, same bits. Stateless;
// thread-safe. Source: paper, eqs. 1 to 7.
#pragma once

#include "absl/status/statusor.h"
#include "core/sim/model/scene.h"
#include "core/sim/model/trajectory.h"

namespace tactus {

// INVALID_SCENE for a bad scene, NUMERICAL_FAILURE if it would need more than
// 10^9 steps.
// `step_share` is the length of a step as a share of the fastest motion's time
// scale; a loss of contact that begins and ends within one step goes unseen.
absl::StatusOr<Trajectory> IntegrateReference(const ContactScene& scene,
                                              double sample_rate_hz,
                                              double step_share = 0.7);

}  // namespace tactus
