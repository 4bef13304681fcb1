// File: record_contacts.h
//
// Records any number of simulated contacts with one simulated skin: each taxel
// reads the sum of what the objects press on it, with the noise, drift and
// faults of the skin throughout. record_contact.h is the case of one contact.
//
//   const PlacedContact contacts[] = {
//       {.contact = &first, .centre = {.row = 2, .column = 3},
//        .begin_frame = 100, .end_sample = 300},
//       {.contact = &second, .centre = {.row = 8, .column = 23.5},
//        .begin_frame = 180, .end_sample = 250}};
//   Trial trial = RecordContacts(metadata, contacts, skin, motion, random);
//
// How the objects hold each other back is in the contacts already
// (core/sim/coupled/press_together.h). The same arguments give the same bits.
// Stateless; thread-safe with one generator for each thread.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "Eigen/Core"
#include "core/base/random.h"
#include "core/data/trial.h"
#include "core/sim/skin/simulated_contact.h"
#include "core/sim/skin/skin_model.h"
#include "core/skin/geometry.h"

namespace tactus::internal {

// A contact and where and when it presses. `contact` must outlive it.
struct PlacedContact {
  const SimulatedContact* contact = nullptr;
  // Middle of the object's face.
  SkinPoint centre;
  // Angle between the face and the cylinder's axis, rad.
  double tilt_rad = 0;
  // The frame that reads the contact's sample 0, 10 ms after its touch.
  size_t begin_frame = 0;
  // The samples from begin_sample to before end_sample press; the others
  // belong to the motion alone.
  size_t begin_sample = 0;
  size_t end_sample = 0;
};

// Where the link is at one frame: `distance_m` times `direction` away from
// where it was at the first touch. The direction may have any length.
struct LinkStep {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  double distance_m = 0;
};

// The motion of the link during a recording, and how its poses measure it.
struct LinkMotion {
  // One for each frame.
  std::vector<LinkStep> steps;
  // Standard deviation of each coordinate of a pose, m.
  double pose_noise_m = 0;
  // Error of the poses that grows with the motion: 0.01 means 1 % too far.
  double pose_gain_error = 0;
};

// Returns `metadata` with time, taxels, poses and skin. All contacts fit the
// skin's layout and end with the motion or before.
Trial RecordContacts(const Trial& metadata,
                     std::span<const PlacedContact> contacts,
                     const SkinModel& skin, const LinkMotion& motion,
                     Random& random);

}  // namespace tactus::internal
