// File: skin_model.h
//
// SkinModel: a simulated skin, from its cover to the numbers that it sends.
// Three of them have names:
//
//   paper     as fine as the skin of the paper's simulation: every contact of
//             its set is felt. Noise of 1 uN, which no real skin reaches, and
//             poses as fine.
//   good      a skin with the electronics of today: 2 mN of noise, and light
//             touch.
//   measured  what the one real frame of the paper's forearm shows, and what
//             such skins do: stray taxels of 24 to 97 mN, offsets that drift,
//             readings that lag, dead taxels, and light touch.
//
//   TACTUS_ASSIGN_OR_RETURN(const SkinModel skin, SkinModelNamed("good"));
//
// All have the shape of the layout "cody-forearm" and a cover of 2e7 N/m^3, for
// which a force like that of the real frame touches 4 x 2 taxels, as there.
// Plain data; safe to share between threads once built.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/skin/layout.h"

namespace tactus::internal {

struct SkinModel {
  std::string name;
  SkinLayout layout;
  // Pressure for each metre by which the cover is compressed, N/m^3.
  double cover_n_m3 = 2e7;
  // Standard deviation of each reading, N: the same at any force.
  double noise_n = 0;
  // Step to which readings are rounded, N; 0: not rounded. Readings end at 0,
  // and at 65,535 steps.
  double step_n = 0;
  // Standard deviation of each taxel's offset after 1 s; it grows with the
  // square root of the time. N.
  double drift_n = 0;
  // Part of a reading that follows the force with a time constant.
  double lagging = 0;
  double lag_s = 0;
  // Taxels that always read 0, and taxels with an offset between two values, N.
  // Their places and offsets are drawn anew for each contact.
  int dead_taxels = 0;
  int stray_taxels = 0;
  double stray_min_n = 0;
  double stray_max_n = 0;
  // How well the robots that carry it know the link's pose: the range of the
  // standard deviation of each coordinate, m, and of the error that grows with
  // the motion.
  double pose_noise_min_m = 5e-5;
  double pose_noise_max_m = 2e-3;
  double pose_gain_error_max = 0.02;
};

// INVALID_CONFIG for any other name.
absl::StatusOr<SkinModel> SkinModelNamed(absl::string_view name);

}  // namespace tactus::internal
