// File: highway_targets.h
//
// Selects the instruction sets that the kernels are compiled for: SSE4, AVX2
// and AVX-512 on x86-64, NEON on arm64, plain C++ elsewhere. More sets would
// gain little, and each costs compile time. Scalable vectors are left out
// because their size is not known at compile time.
//
// Sanitizers instrument every set again; they get AVX2 and plain C++ only.
//
// It is a separate header because it must come before every header of Highway.
#pragma once

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HWY_DISABLED_TARGETS                                            \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | \
   HWY_SVE_256 | HWY_SVE2_128)
#else
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#endif
