// File: consensus.h
//
// Consensus: what two evaluations of a question in a row agree on. Noise makes
// one evaluation in hundreds sure of a change that is not there; the next one
// is not.
//
//   const double before[] = {0.99, 0.01};
//   double now[] = {0.04, 0.96};
//   Consensus(before, now);  // now is {0.17, 0.83}
//
// If both have the same most probable value, it is the less sure of them. If
// not, or if there is none before, the evaluation counts half: it is its root,
// normalised. Thread-safe; allocates nothing.
#pragma once

#include <span>

namespace tactus::internal {

// Both have one probability per value; they sum to 1. `before` may be empty.
void Consensus(std::span<const double> before, std::span<double> now);

}  // namespace tactus::internal
