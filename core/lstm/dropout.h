// File: dropout.h
//
// Which connections between layers are dropped in one training step (paper:
// "a dropout layer in between the two layers"): each number at each step on
// its own, those kept enlarged so that the mean stays (Srivastava et al., JMLR
// 2014). Inference drops nothing.
//
//   DropoutMask(0.2, random, mask);  // 0 or 1.25
//
// Thread-safe: a free function; `random` is the caller's.
#pragma once

#include <span>

#include "core/base/random.h"

namespace tactus {

// Factors whose mean is 1: 0 with `probability`, below 1 and rounded to
// 1/65536, else one number above 1.
void DropoutMask(double probability, Random& random, std::span<float> mask);

}  // namespace tactus
