// File: highway_targets.h
//
// Selects the instruction sets that the kernels are compiled for: SSE4, AVX2
// and AVX-512 on x86-64, NEON on arm64, plain C++ elsewhere. More sets would
// gain little, and each costs compile time. Scalable vectors are left out
// because their size is not known at compile time.
//
// Sanitizers instrument every set again; they get AVX2 and plain C++ only, and
// clang plain C++ without Highway's emulation of vectors, which takes a minute.
//
// It is a separate header because it must come before every header of Highway.
#pragma once

#include "absl/base/config.h"

// On arm64, the build leaves scalable vectors out of all other kernels too.
#undef HWY_DISABLED_TARGETS
#if defined(ABSL_HAVE_ADDRESS_SANITIZER) || defined(ABSL_HAVE_THREAD_SANITIZER)
#define HWY_DISABLED_TARGETS                                            \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | \
   HWY_SVE_256 | HWY_SVE2_128)
#define HWY_BROKEN_EMU128 1
#else
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#endif
