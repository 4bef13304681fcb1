// File: rate_check.h
//
// The rate that the times of a recording have, compared with the stated one.
//
//   const RateCheck check = CheckRate({0, 0.02, 0.04}, /*stated_hz=*/50);
//   check.measured_hz;  // 50
//   check.error;        // empty
//
// Thread-safe: a free function without state.
#pragma once

#include <string>
#include <vector>

namespace tactus::internal {

struct RateCheck {
  // Frames a second; 0 for fewer than two frames.
  double measured_hz = 0;
  // Beyond 20 %: what is wrong, to be put after "sample_rate_hz: ". Else empty.
  std::string error;
  // A sentence about the unit of the times, if they look like those of another,
  // or about a pause. Else empty.
  std::string advice;
  // Beyond 5 %, which users should know of.
  bool remarkable = false;
};

// `times` rise, in seconds.
RateCheck CheckRate(const std::vector<double>& times, double stated_hz);

}  // namespace tactus::internal
