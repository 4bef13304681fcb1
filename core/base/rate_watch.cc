#include "core/base/rate_watch.h"

#include <cmath>

namespace tactus::internal {
namespace {

// As a stream's rate may differ from its model's.
constexpr double kMostDifference = 0.05;
// A window slower by this factor counts twice. A faster one does not, because
// frames that waited may come at once.
constexpr double kFarFactor = 1.5;
constexpr double kWindowS = 0.5;
// A slow skin sends few frames in a window.
constexpr double kLeastFrames = 5;
// Times that are early or late by up to 75 ms cannot reach it: what they add
// to one window they take from another.
constexpr int kMostDoubt = 3;

}  // namespace

bool RateWatch::Add(uint32_t frames, int64_t first_ns, uint64_t lost_before) {
  if (last_.frames > 0) {
    AddSpan(
        {static_cast<double>(last_.frames) + static_cast<double>(lost_before),
         static_cast<double>(first_ns - last_.first_ns)});
  }
  last_ = {frames, first_ns};
  if (differs_ || doubt_ < kMostDoubt) return false;
  differs_ = true;
  return true;
}

void RateWatch::AddSpan(const Span& span) {
  window_.frames += span.frames;
  window_.ns += span.ns;
  if (span.ns * longest_.frames >= longest_.ns * span.frames) longest_ = span;
  const bool complete =
      window_.frames >= kLeastFrames &&
      (window_.ns >= kWindowS * 1e9 || window_.frames >= kWindowS * stated_hz_);
  if (!complete) return;
  measured_hz_ = RateOfWindow();
  window_ = {};
  longest_ = {};
  const double ratio = measured_hz_ / stated_hz_;
  if (!(std::abs(ratio - 1) > kMostDifference)) {
    doubt_ = 0;
    return;
  }
  if (too_fast_ != (ratio > 1)) doubt_ = 0;
  too_fast_ = ratio > 1;
  doubt_ += ratio * kFarFactor <= 1 ? 2 : 1;
}

// The nearer one to the stated rate of two: with the longest interval, and
// without.
double RateWatch::RateOfWindow() const {
  const double whole = window_.frames * 1e9 / window_.ns;
  const double rest_ns = window_.ns - longest_.ns;
  if (!(rest_ns > 0)) return whole;
  const double rest = (window_.frames - longest_.frames) * 1e9 / rest_ns;
  const auto far = [this](double hz) {
    return std::abs(std::log(hz / stated_hz_));
  };
  return far(rest) < far(whole) ? rest : whole;
}

}  // namespace tactus::internal
