// File: schedule.h
//
// Schedule: when each message of each robot is to be sent. Every robot sends
// at the same period with a separate phase. The times follow from the
// numbers alone, so that a generator that falls behind cannot shift them.
//
//   schedule.DueNs(robot, message);
//
// Plain data; thread-safe to read.
#pragma once

#include <cstdint>
#include <vector>

namespace tactus::internal::client {

class Schedule {
 public:
  // `robots` phases drawn from `seed`, ascending, within one period of
  // `period_ns`, from `start_ns` on.
  Schedule(int robots, int64_t start_ns, int64_t period_ns, uint64_t seed);

  int64_t DueNs(int robot, uint64_t message) const {
    return start_ns_ + phases_ns_[robot] +
           static_cast<int64_t>(message) * period_ns_;
  }
  int robots() const { return static_cast<int>(phases_ns_.size()); }
  int64_t start_ns() const { return start_ns_; }
  int64_t period_ns() const { return period_ns_; }

 private:
  int64_t start_ns_;
  int64_t period_ns_;
  std::vector<int64_t> phases_ns_;
};

}  // namespace tactus::internal::client
