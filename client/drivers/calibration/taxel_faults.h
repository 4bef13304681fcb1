// File: taxel_faults.h
//
// Taxels that are better masked, found in frames of an untouched skin:
//
// - stuck: reads one value, which OutstandingTaxels lists
// - dead: reads one value like that of other taxels, although half of the
//   taxels change in one of ten frames or more
// - noisy: has more than 6 times the median noise of the skin, and more than 2
//   steps of its numbers
//
// On a skin of three axes each axis is examined beside the same axis of the
// others. A taxel is faulty if one of its axes is; it has the first of those
// faults in the list above.
//
//   const TaxelFaults faults = FindFaults(idle, baseline, noise);
//   for (const int taxel : faults.All()) Mask(taxel);
//
// Skins that read 0 where nothing presses show dead taxels only when they are
// pressed: PressSweep finds them. Masked taxels are not examined. Plain data
// and free functions without state; thread-safe.
#pragma once

#include <vector>

#include "client/drivers/calibration/idle_frames.h"
#include "client/drivers/calibration/taxel_noise.h"

namespace tactus::internal::client {

// Row-major indices, rising. A taxel has one fault at most.
struct TaxelFaults {
  std::vector<int> dead;
  std::vector<int> stuck;
  std::vector<int> noisy;

  // All of them, rising.
  std::vector<int> All() const;
  bool operator==(const TaxelFaults&) const = default;
};

TaxelFaults FindFaults(const IdleFrames& idle,
                       const std::vector<double>& baseline,
                       const std::vector<ValueNoise>& noise);

}  // namespace tactus::internal::client
