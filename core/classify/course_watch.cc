#include "core/classify/course_watch.h"

#include <algorithm>
#include <cmath>

namespace tactus::internal {
namespace {

// Weights of a frame in the level, in the slope and in the variance of errors.
// Earlier frames are few at first, and the weights of a plain mean are larger.
constexpr double kLevelWeight = 0.1;
constexpr double kSlopeWeight = 0.1;
constexpr double kVarianceWeight = 0.02;
// Errors of the first frames say how large the noise is.
constexpr int kFirstFrames = 4;
// An error counts as at most so many standard deviations, so that one frame
// does not end a course; each is lowered by kSlack, so that noise sums to
// nothing.
constexpr double kLargest = 4;
constexpr double kSlack = 1;
// The sum at which the course has been left. Weights and sums from half to
// twice these give the same delays in the random world within 20 ms, and 6 to
// 13 looks a contact.
constexpr double kLeft = 12;

}  // namespace

void CourseWatch::Reset() {
  channels_ = {};
  frames_ = 0;
}

void CourseWatch::Restart() {
  for (Channel& channel : channels_) channel.above = channel.below = 0;
}

bool CourseWatch::Step(const ContactSample& sample) {
  const double values[] = {sample.net_force,
                           sample.features[static_cast<int>(Feature::kArea)],
                           sample.features[static_cast<int>(Feature::kMotion)],
                           std::hypot(sample.shear.first, sample.shear.second)};
  bool left = false;
  for (size_t i = 0; i < channels_.size(); ++i) {
    left |= Step(values[i], channels_[i]);
  }
  ++frames_;
  return left;
}

bool CourseWatch::Step(double value, Channel& channel) const {
  if (frames_ == 0) {
    channel.level = value;
    return false;
  }
  const double mean_weight = 1.0 / (frames_ + 1);
  const double error = value - channel.level - channel.slope;
  const double level_weight = std::max(kLevelWeight, mean_weight);
  channel.level += channel.slope + level_weight * error;
  channel.slope +=
      level_weight * std::max(kSlopeWeight, mean_weight / 2) * error;
  const bool first = frames_ < kFirstFrames;
  // Without noise every error is a large one.
  const double deviations =
      error == 0 ? 0
                 : std::clamp(error / std::sqrt(channel.variance), -kLargest,
                              kLargest);
  const bool limited = !first && channel.variance > 0;
  const double square =
      limited ? std::min(error * error, 9 * channel.variance) : error * error;
  channel.variance +=
      std::max(kVarianceWeight, mean_weight) * (square - channel.variance);
  if (first) return false;
  channel.above = std::max(0.0, channel.above + deviations - kSlack);
  channel.below = std::max(0.0, channel.below - deviations - kSlack);
  return channel.above > kLeft || channel.below > kLeft;
}

}  // namespace tactus::internal
