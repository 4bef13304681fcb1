// File: frontier_pruned.h
//
// What leaving out HMM states would bring: the forward algorithm, scaled in
// double, of the states that hold a share of their category's forward mass.
// What is served looks at all states (docs/skipping.md).
//
//   auto rung = MakePrunedRung(mixtures, 1e-8);
//
// Rungs as in frontier_rungs.h.
#pragma once

#include <memory>
#include <vector>

#include "tests/bench/frontier_rungs.h"

namespace tactus::client {

// mixtures: valid. After each frame, states that hold no more than `bound` of
// their category's forward mass are left out, until a state that is not leads
// to them; at 0 those of which nothing is left in double.
std::unique_ptr<Rung> MakePrunedRung(const std::vector<HmmMixture>& mixtures,
                                     double bound);

}  // namespace tactus::client
