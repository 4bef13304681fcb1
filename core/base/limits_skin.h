// File: limits_skin.h
//
// Limits of skins, beside those in limits.h. Thread-safe: constants.
#pragma once

#include <cstddef>

namespace tactus::internal::limits {

// Taxels of a skin that carry something else than touch.
inline constexpr size_t kMaxAuxiliaryTaxels = 64;
// Magnetometers of a magnetic skin on one serial line.
inline constexpr int kMaxMagnetometers = 64;

}  // namespace tactus::internal::limits
