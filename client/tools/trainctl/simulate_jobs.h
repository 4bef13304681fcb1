// File: simulate_jobs.h
//
// What `trainctl simulate` simulates, as jobs that run in any order, each on
// its own: the paper's contacts, a grid of other robot conditions, or the
// robot Cody's.
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
#include "core/sim/skin/render.h"
#include "core/skin/layout.h"

namespace tactus::client {

struct SimulateFlags {
  std::string protocol = "paper";
  std::string sensor = "signals";
  uint64_t seed = 1;
  std::string out;
  // Empty: those of the protocol.
  std::vector<double> stiffnesses;
  std::vector<double> velocities;
  std::vector<double> goals;
  // Table of materials (ParseMaterials); empty: the paper's.
  std::string materials;
  // Trials of the grid; the others run in full.
  int sample = 2000;
  RenderOptions render;
  bool json = false;

  bool taxels() const { return sensor == "taxels"; }
};

// One contact as the sensor gives it.
struct SensedContact {
  Trial trial;
  // Some sample's strain had to be clamped.
  bool clamped = false;
};

// One contact and, where the protocol says so, the same with the object fixed
// if it moved.
using SimulateJob = std::function<absl::StatusOr<std::vector<SensedContact>>()>;

// INVALID_CONFIG naming the flag if flags are unknown or do not go together;
// IO or INVALID_SCENE for the table of materials.
absl::StatusOr<std::vector<SimulateJob>> MakeJobs(const SimulateFlags& flags,
                                                  const SkinLayout& layout);

}  // namespace tactus::client
