// File: gaussian.h
//
// Draws many Gaussian random numbers at once, with vector instructions. They
// equal those of Random::Gaussian() up to rounding.
//
//   std::vector<double> noise(1500);
//   FillGaussian(random, noise);
//
// Uses only arithmetic and square roots, so every platform and every vector
// width gives the same bits. Compiled for several widths by Highway.
// Thread-safe as long as each thread has its generator. Source: Box and Muller,
// "A note on the generation of random normal deviates" (1958).
#pragma once

#include <span>

#include "core/base/random.h"

namespace tactus::internal {

// Fills `deviates` with numbers of zero mean and unit variance. Takes two
// uniform numbers for each pair of deviates, and two for an odd last one.
void FillGaussian(Random& random, std::span<double> deviates);

}  // namespace tactus::internal
