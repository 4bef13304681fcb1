// File: sim_driver.h
//
// SimDriver: contacts from the simulator (core/sim), rendered as u16 taxel
// frames of the cody-forearm skin with sensor noise, one pose a frame.
//
// Trial i is of class i mod 4 of HU, HM, SU, SM. Its robot condition lies
// between those of the paper, where no model was trained; its object is any of
// the paper's. Seed and index fix the trial, whatever the number of drivers.
//
//   SimDriver driver({.seed = 7}, /*trials=*/40, {});
//
// Not thread-safe: one thread a driver.
#pragma once

#include <cstdint>

#include "client/drivers/trial_driver.h"
#include "core/sim/skin/render.h"

namespace tactus::client {

class SimDriver : public TrialDriver {
 public:
  struct Options {
    uint64_t seed = 1;
    RenderOptions render = {};
  };

  SimDriver(const Options& options, size_t trials, const Shard& shard)
      : TrialDriver(shard, trials), options_(options) {}

 protected:
  absl::StatusOr<Trial> MakeTrial(size_t index) override;

 private:
  const Options options_;
};

}  // namespace tactus::client
