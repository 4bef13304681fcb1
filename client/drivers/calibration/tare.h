// File: tare.h
//
// Tare: the mean of each value over frames in which nothing touches the skin,
// refused if something does. A value is a taxel's reading along one axis.
//
//   TACTUS_ASSIGN_OR_RETURN(const std::vector<double> baseline,
//                           Tare(idle, /*before=*/nullptr));
//
// There are no thresholds yet, so a touch is known from these signs:
//
// - A value changes, along whichever axis. The frames are divided into four
//   parts. The noise of a value is the median change from a frame to the next,
//   as a standard deviation, and not less than a quarter of the skin's median
//   on that axis. If the means of two parts differ by more than 6 deviations
//   and 3 steps of the skin's numbers, the skin is touched. A shorter touch
//   moves the mean of all frames by less than 1.5 deviations.
// - A taxel rose since an earlier calibration by more than its contact
//   threshold above the median rise of all taxels on each axis, which may be a
//   drift. On a skin of three axes or with signs it may also have fallen, or
//   moved along the skin (touch_thresholds.h).
//
// Without an earlier calibration, something that rests on the skin all the
// while looks like an offset of the taxels. OutstandingTaxels lists them.
//
// Thread-safe: free functions without state.
#pragma once

#include <cstddef>
#include <vector>

#include "absl/status/statusor.h"
#include "client/drivers/calibration/calibration.h"
#include "client/drivers/calibration/idle_frames.h"

namespace tactus::internal::client {

// Fewest frames of a tare.
inline constexpr size_t kMinTareFrames = 20;

// Means of all values, in the numbers that the skin sends. INVALID_CONFIG if
// there are fewer than kMinTareFrames frames; INVALID_TRAINING_DATA, which
// names the taxel and the axis, if the skin is touched. Masked taxels are not
// examined. `before` fits the skin; it may be null.
absl::StatusOr<std::vector<double>> Tare(const IdleFrames& idle,
                                         const Calibration* before);

// For each value: its baseline is more than 10 deviations and 8 steps above the
// median of its axis, or, on a skin of three axes or with signs, beside it. A
// deviation is that of a Gaussian with the same median absolute deviation.
// False for masked taxels.
std::vector<bool> OutstandingValues(const IdleFrames& idle,
                                    const std::vector<double>& baseline);

// Taxels of which one value or more is outstanding, rising.
std::vector<int> OutstandingTaxels(const IdleFrames& idle,
                                   const std::vector<double>& baseline);

}  // namespace tactus::internal::client
