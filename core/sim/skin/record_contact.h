// File: record_contact.h
//
// Records a simulated contact with a simulated skin: taxel frames, and the pose
// of the link that carries the skin.
//
//   TACTUS_ASSIGN_OR_RETURN(const SkinModel skin, SkinModelNamed("good"));
//   Random random = Random::ForStream(seed, contact.spec.number);
//   const Placement placement = DrawPlacement(skin.layout, random);
//   Trial trial = RecordContact(contact, skin, placement, random);
//   if (!Detectable(trial, skin.layout)) ++never_felt;
//
// The object's face is pressed against the cover along a line
// (line_contact.h). Frame `lead_in_frames - 1 + j` is read j / 100 s after the
// touch; before it the arm rests or, if it has an approach, moves freely. The
// same arguments give the same bits. Stateless; thread-safe with one
// generator for each thread.
#pragma once

#include "core/base/random.h"
#include "core/data/trial.h"
#include "core/sim/skin/simulated_contact.h"
#include "core/sim/skin/skin_model.h"
#include "core/skin/geometry.h"

namespace tactus::internal {

// Where a contact happens, and how well the robot knows its pose.
struct Placement {
  // Middle of the object's face.
  SkinPoint centre;
  // Angle between the face and the cylinder's axis, rad.
  double tilt_rad = 0;
  // Standard deviation of each coordinate of a pose, m.
  double pose_noise_m = 0.00005;
  // Error of the poses that grows with the motion: 0.01 means 1 % too far.
  double pose_gain_error = 0;
  // Frames before the touch. A skin with light touch needs 30 of them for its
  // background, which is steady after 100.
  int lead_in_frames = 100;
};

// Any place on the skin; a tilt with a standard deviation of 0.5 degrees.
Placement DrawPlacement(const SkinLayout& layout, Random& random);

// The contact as taxel frames with one pose each. The link moves along the
// skin's outward normal at the centre. `placement` fits the skin's layout.
Trial RecordContact(const SimulatedContact& contact, const SkinModel& skin,
                    const Placement& placement, Random& random);

// True if a stream of the trial's frames detects a contact: by a valid taxel or
// by light touch, whichever `layout` has. `trial` has taxels of `layout`.
bool Detectable(const Trial& trial, const SkinLayout& layout);

}  // namespace tactus::internal
