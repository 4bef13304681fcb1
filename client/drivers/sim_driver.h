// File: sim_driver.h
//
// SimDriver: contacts from the simulator (core/sim), recorded by a named skin
// (core/sim/skin/skin_model.h) with one pose a frame.
//
// Trial i is of class i mod 4 of HU, HM, SU, SM, as an observer would name it:
// an object that moved by at most 1 mm is unmoved. Its robot condition lies
// between those of the paper; its object is any of the paper's. Seed and index
// fix the trial, whatever the number of drivers.
//
//   SimDriver driver({.seed = 7}, /*trials=*/40, {});
//
// Not thread-safe: one thread a driver.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/drivers/trial_driver.h"
#include "core/skin/geometry.h"

namespace tactus::internal::client {

class SimDriver : public TrialDriver {
 public:
  struct Options {
    uint64_t seed = 1;
    // "paper", "good" or "measured".
    std::string skin = "good";
    // With several, a trial is a scene of so many objects at once
    // (core/sim/experiments/random_scene.h), labelled as the first one; the
    // two options below do not apply.
    int objects = 1;
    // Frames before the touch; 0 for those of Placement.
    int lead_in_frames = 0;
    // Where all contacts are; nothing for places drawn from the seed.
    std::optional<SkinPoint> centre = std::nullopt;
  };

  SimDriver(const Options& options, size_t trials, const Shard& shard)
      : TrialDriver(shard, trials), options_(options) {}

 protected:
  absl::StatusOr<Trial> MakeTrial(size_t index) override;

 private:
  const Options options_;
};

}  // namespace tactus::internal::client
