// File: simulate_jobs.h
//
// The contacts of `trainctl simulate` as independent jobs, which may run in any
// order: the paper's contacts, a grid of other robot conditions, or the
// contacts of the robot Cody.
//
//   TACTUS_ASSIGN_OR_RETURN(auto jobs, MakeJobs(flags, layout));
//   TACTUS_ASSIGN_OR_RETURN(std::vector<SensedContact> contacts, jobs[0]());
//
// Jobs keep references to the flags and the layout; both must outlive them.
// Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/data/trial.h"
#include "core/sim/experiments/random_scene.h"
#include "core/skin/layout.h"

namespace tactus::internal::client {

struct SimulateFlags {
  std::string protocol = "paper";
  // Noise of signals (ParseNoiseReading); empty for the default.
  std::string noise;
  uint64_t seed = 1;
  std::string out;
  // Empty for those of the protocol.
  std::vector<double> stiffnesses;
  std::vector<double> velocities;
  std::vector<double> goals;
  // Table of materials (ParseMaterials); empty for the paper's.
  std::string materials;
  // Trials of the grid; the others run in full.
  int sample = 2000;
  // A named skin (SkinModelNamed) that records the contacts; empty for ideal
  // signals.
  std::string skin;
  // Trials of the random world.
  int64_t contacts = 1000;
  // Contacts of each of them.
  SceneOptions scene;
  // Each of these contacts in a trial of its own, as if it were alone.
  bool alone = false;
  bool json = false;
};

// One trial as the sensor measures it.
struct SensedContact {
  Trial trial;
  // Some sample's strain had to be clamped.
  bool clamped = false;
};

// `count` jobs, each made when it runs. A job simulates one contact. If the
// object moved and the protocol asks for it, it also simulates the same contact
// with a fixed object.
struct SimulateJobs {
  size_t count = 0;
  std::function<absl::StatusOr<std::vector<SensedContact>>(size_t)> run;
};

// The layout of the skin `flags` name. Without one, that of the skin on which
// Cody's contacts are placed. INVALID_CONFIG with the exit code of wrong usage
// if there is no such skin.
absl::StatusOr<SkinLayout> LayoutOf(const SimulateFlags& flags);

// `noise`, the name of a reading of the noise, or that of the default if it is
// empty.
std::string NoiseOrDefault(const std::string& noise);

// Returns INVALID_CONFIG that names the flag if a value is unknown or flags
// exclude each other; IO or INVALID_SCENE for the table of materials.
absl::StatusOr<SimulateJobs> MakeJobs(const SimulateFlags& flags,
                                      const SkinLayout& layout);

}  // namespace tactus::internal::client
