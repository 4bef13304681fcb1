// File: gaussian.h
//
// Many Gaussian random numbers at once, two at a time in the processor's
// vectors: what Random::Gaussian() would have drawn, up to rounding.
//
//   std::vector<double> noise(1500);
//   FillGaussian(random, noise);
//
// Arithmetic and square roots alone, so the same bits on every platform.
// Stateless; the generator is the caller's. Source: Box and Muller, "A note on
// the generation of random normal deviates" (1958).
#pragma once

#include <span>

#include "core/base/random.h"

namespace tactus {

// Zero mean, unit variance. Takes two uniform numbers for each two deviates,
// and for an odd one at the end.
void FillGaussian(Random& random, std::span<double> deviates);

}  // namespace tactus
