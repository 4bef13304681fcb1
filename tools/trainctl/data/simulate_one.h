// File: simulate_one.h
//
// `trainctl simulate --one JSON`: one noiseless contact as CSV, for plots and
// for comparison with other simulators.
//
//   OneContactFlags flags;
//   AddOneContactFlags(*command, flags);
//   if (!flags.scene.empty()) return SimulateOne(flags, std::cout);
//
// Keys of the JSON object, all optional: m_arm (kg), k_act (N/m), b_act
// (N s/m; critical damping if absent), v (m/s), goal (m), m_obj (kg), k_obj
// (N/m), mu_s, mu_k, fixed (true or false), duration (s). Columns: t, x_arm,
// v_arm, x_uobj, v_uobj, F_surf, in SI units.
#pragma once

#include <ostream>
#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/sim/model/scene.h"

namespace tactus::internal::client {

struct OneContactFlags {
  // The JSON text, or @ and the name of a file that holds it; empty: the
  // command was given without --one.
  std::string scene;
  double rate_hz = 2000;
  bool csv = false;
};

void AddOneContactFlags(CLI::App& command, OneContactFlags& flags);

// INVALID_SCENE naming the key or field that is wrong.
absl::StatusOr<ContactScene> ParseScene(absl::string_view json);

// Writes the contact's samples to `out`. INVALID_SCENE, INVALID_CONFIG for a
// bad flag, IO for an unreadable file, NUMERICAL_FAILURE.
absl::Status SimulateOne(const OneContactFlags& flags, std::ostream& out);

}  // namespace tactus::internal::client
