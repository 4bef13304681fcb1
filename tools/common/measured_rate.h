// File: measured_rate.h
//
// MeasuredRate: the rate at which a skin sends, from the times of its frames,
// to be compared with the rate that it was configured for.
//
//   MeasuredRate rate;
//   rate.Add(frame);
//   TACTUS_RETURN_IF_ERROR(rate.Check(info.sample_rate_hz));
//
// Not thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "client/stream/skin_frame.h"

namespace tactus::internal::client {

class MeasuredRate {
 public:
  void Add(const SkinFrame& frame);
  // Frames per second: the mean over those times between frames that are half
  // to one and a half of their median, if most are; else, as of a skin that
  // sends several frames at once, the mean over all that are no pauses. 0
  // before the second frame. Lost frames are not counted by
  // SkinFrame::missing_before, because a driver derives it from the configured
  // rate.
  double hz() const;
  size_t frames() const { return periods_s_.size() + (last_ns_ ? 1 : 0); }
  // INVALID_CONFIG if the rate differs by more than 5 % from `configured_hz`,
  // as a model's rate may not either.
  absl::Status Check(double configured_hz) const;

 private:
  std::optional<int64_t> last_ns_;
  std::vector<double> periods_s_;
};

}  // namespace tactus::internal::client
