// File: highway_targets.h
//
// The instruction sets that kernels are compiled for: SSE4, AVX2 and AVX-512 on
// x86-64, NEON on arm64, plain C++ elsewhere. More would gain little and each
// costs compile time; scalable vectors have no size at compile time.
//
// Include it before any header of Highway.
#pragma once

#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
