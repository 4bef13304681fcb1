// File: taxel_kernels.h
//
// The loops over all taxels of a simulated skin's electronics
// (record_contact.h). Each taxel's numbers are computed alike at any vector
// width, so all widths give the same bits.
//
//   taxel_kernels::Read(forces, {.noise_n = 0.002}, state, readings.data());
//   taxel_kernels::Quantise(readings, /*step=*/0.001, steps.data());
//
// Compiled for several vector widths by Highway. Thread-safe: free functions
// without state. Nothing allocates.
#pragma once

#include <cstdint>
#include <span>

namespace tactus::internal::taxel_kernels {

struct Electronics {
  // Standard deviation of the noise, N.
  double noise_n = 0;
  // Part of a reading that lags, and how far it moves towards the force in a
  // frame.
  double lagging = 0;
  double follow = 0;
};

// Arrays with one number per taxel.
struct TaxelState {
  // 1, or 0 for a dead taxel.
  const double* alive;
  // N, and noise in standard deviations.
  const double* offset;
  const double* deviates;
  // The force with its lag, N. Changed.
  double* lagging;
};

// Writes what the taxels read under `forces`, N, at least 0.
void Read(std::span<const double> forces, const Electronics& electronics,
          const TaxelState& state, double* readings);

// Writes readings / step as whole numbers, at most 65,535. Halves are rounded
// up. No reading is below 0; `step` is above 0.
void Quantise(std::span<const double> readings, double step, uint16_t* steps);

}  // namespace tactus::internal::taxel_kernels
