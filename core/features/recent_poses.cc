#include "core/features/recent_poses.h"

#include <algorithm>
#include <cmath>

namespace tactus::internal {
namespace {

constexpr int kLinePoses = 4;
// Standard deviations by which two estimates may differ.
constexpr double kAgree = 3;

// A coordinate at regular or irregular times, the newest first.
struct Way {
  std::array<double, RecentPoses::kMaxPoses> time;
  std::array<double, RecentPoses::kMaxPoses> value;
  int size = 0;
};

// An estimate of the coordinate at time 0, and its variance in that of one
// value.
struct Estimate {
  double value = 0;
  double variance = 1;
};

Estimate Mean(const Way& way) {
  Estimate mean = {0, 1.0 / way.size};
  for (int i = 0; i < way.size; ++i) mean.value += way.value[i] / way.size;
  return mean;
}

// A straight line through the newest `size` values.
Estimate Line(const Way& way, int size) {
  double mean_time = 0;
  double mean_value = 0;
  for (int i = 0; i < size; ++i) {
    mean_time += way.time[i] / size;
    mean_value += way.value[i] / size;
  }
  double time_time = 0;
  double time_value = 0;
  for (int i = 0; i < size; ++i) {
    const double t = way.time[i] - mean_time;
    time_time += t * t;
    time_value += t * (way.value[i] - mean_value);
  }
  return {mean_value - mean_time * time_value / time_time,
          1.0 / size + mean_time * mean_time / time_time};
}

// Variance of one value, from second differences. Irregular times make it too
// large, and the estimate smoother.
double NoiseVariance(const Way& way) {
  double sum = 0;
  for (int i = 2; i < way.size; ++i) {
    const double bend = way.value[i] - 2 * way.value[i - 1] + way.value[i - 2];
    sum += bend * bend / 6;
  }
  return sum / (way.size - 2);
}

double Smoothest(const Way& way) {
  if (way.size < kLinePoses) return Mean(way).value;
  std::array<Estimate, 5> estimates;
  int count = 0;
  estimates[count++] = Mean(way);
  for (int size = way.size; size >= std::max(way.size / 4, kLinePoses);
       size /= 2) {
    estimates[count++] = Line(way, size);
  }
  estimates[count++] = {way.value[0], 1};
  const double noise = kAgree * kAgree * NoiseVariance(way);
  const auto agrees = [&](int first, int later) {
    const double gap = estimates[first].value - estimates[later].value;
    return gap * gap <=
           noise * (estimates[later].variance - estimates[first].variance);
  };
  for (int first = 0;; ++first) {
    bool all = true;
    for (int later = first + 1; later < count; ++later) {
      all &= agrees(first, later);
    }
    if (all) return estimates[first].value;
  }
}

}  // namespace

RecentPoses::RecentPoses(double sample_rate_hz) : spacing_(sample_rate_hz) {}

void RecentPoses::Reset() {
  spacing_.Reset();
  count_ = 0;
}

void RecentPoses::Add(const Pose* pose, uint64_t missing_before) {
  if (missing_before >= spacing_.window()) Reset();
  spacing_.Step(missing_before);
  if (pose == nullptr) return;
  if (count_ == 0 || newest_is_kept_) {
    newest_ = (newest_ + 1) % kMaxPoses;
    count_ = std::min(count_ + 1, kMaxPoses);
  }
  entries_[newest_] = {spacing_.frame(), *pose};
  newest_is_kept_ = spacing_.Keep();
}

double RecentPoses::NewestError(const Eigen::Vector3d& link_position,
                                const Eigen::Vector3d& direction) const {
  if (count_ == 0) return 0;
  // Everything is measured from the newest pose, so that neither a link far
  // from the origin nor a long stream costs digits.
  const Entry& newest = At(0);
  const Eigen::Vector3d newest_arm = newest.pose.orientation * link_position;
  Way way;
  for (; way.size < count_; ++way.size) {
    const Entry& entry = At(way.size);
    const uint64_t age = newest.frame - entry.frame;
    if (age >= spacing_.window()) break;
    const Eigen::Vector3d moved =
        (entry.pose.position - newest.pose.position) +
        (entry.pose.orientation * link_position - newest_arm);
    way.time[way.size] = -static_cast<double>(age);
    way.value[way.size] = moved.dot(direction);
  }
  return -Smoothest(way);
}

}  // namespace tactus::internal
