// File: trajectory.h
//
// Trajectory: the motion of arm and object in one simulated contact, sampled at
// a fixed rate. IntegrateExact (core/sim/exact/exact.h) returns it.
//
//   const TrajectorySample& sample = trajectory.samples[i];
//   const double time = i / trajectory.sample_rate_hz;
//
// Plain data; owns its arrays.
#pragma once

#include <cstdint>
#include <vector>

namespace tactus::internal {

struct TrajectorySample {
  double x_arm = 0;   // m
  double v_arm = 0;   // m/s
  double x_uobj = 0;  // m, position of the undeformed object
  double v_uobj = 0;  // m/s
  double force = 0;   // N, F_surf at this instant
  // Since the start: the integral of F_surf (N s) and the time in contact (s).
  // Their differences give means between samples, which include impacts that
  // are shorter than the sampling interval.
  double impulse = 0;
  double contact_time = 0;
};

struct EventCounts {
  int slips = 0;
  int stops = 0;
  int64_t contacts_lost = 0;
  int64_t contacts_made = 0;

  int64_t Total() const {
    return slips + stops + contacts_lost + contacts_made;
  }
};

struct Trajectory {
  double sample_rate_hz = 0;
  // Sample i is at time i / sample_rate_hz; the first is the touch itself.
  std::vector<TrajectorySample> samples;
  // True if x_uobj > 0 at the end.
  bool moved = false;
  EventCounts events;
};

}  // namespace tactus::internal
