// File: trajectory.h
//
// What an integration method returns: the motion of arm and object, sampled
// at a fixed rate, whichever method made it. Plain data; owns its arrays.
#pragma once

#include <cstdint>
#include <vector>

namespace tactus {

struct TrajectorySample {
  double x_arm = 0;   // m
  double v_arm = 0;   // m/s
  double x_uobj = 0;  // m, position of the undeformed object
  double v_uobj = 0;  // m/s
  double force = 0;   // N, F_surf at this instant
  // Since the start: integral of F_surf (N s) and time spent in contact (s).
  // Their differences give means between samples, in which an impact shorter
  // than the sampling interval is not lost.
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
  // Steps the solver took; 0 if the method takes none.
  int64_t steps = 0;
};

}  // namespace tactus
