// File: render.h
//
// Renders a simulated contact as a real skin would send it: taxel frames with
// sensor noise, quantisation and dead taxels, and the arm's pose with encoder
// noise.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       Trial trial, TaxelTrial(contact, layout, RenderOptions(), seed));
//   if (!Detectable(trial, layout)) ++undetectable;
//
// The noise is absolute, unlike that of SignalTrial, so a very light object may
// stay undetected. Frame `lead_in_frames - 1 + j` is read j / 100 s after the
// touch; earlier frames hold noise only. Same arguments, same bits.
// Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/data/trial.h"
#include "core/sim/skin/simulated_contact.h"
#include "core/skin/geometry.h"
#include "core/skin/layout.h"

namespace tactus {

struct RenderOptions {
  // Middle of the contact patch; unset: drawn evenly over the skin.
  std::optional<SkinPoint> centre;
  // A taxel's reading per newton, in the layout's unit.
  double unit_per_newton = 1;
  // Standard deviation of each taxel's reading, and the step it is rounded
  // to, in the layout's unit. Readings end at 0 and at 65535 steps.
  double taxel_noise = 0.002;
  double taxel_step = 0.001;
  // Taxels that always read 0: these (row-major index), and `dead_count` more
  // drawn from `dead_seed`. They are the same in every trial.
  std::vector<int> dead_taxels;
  int dead_count = 0;
  uint64_t dead_seed = 0;
  // Standard deviation of the arm's position along its motion, in metres: the
  // model's arm has one joint, so one encoder.
  double encoder_noise_m = 0.00005;
  // Frames before the touch.
  int lead_in_frames = 10;
};

// INVALID_SCENE naming the field if an option does not fit the layout.
absl::Status Validate(const RenderOptions& options, const SkinLayout& layout);

// The contact as u16 frames of `layout` with one pose per frame. The link moves
// by x_arm along the skin's outward normal at the patch. Place and noise are
// drawn from `seed` and the trial's number.
absl::StatusOr<Trial> TaxelTrial(const SimulatedContact& contact,
                                 const SkinLayout& layout,
                                 const RenderOptions& options, uint64_t seed);

// True if a valid taxel of any frame reaches the onset threshold, so that a
// stream of these frames detects a contact. `trial` has taxels of `layout`.
bool Detectable(const Trial& trial, const SkinLayout& layout);

}  // namespace tactus
