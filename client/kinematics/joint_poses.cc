#include "client/kinematics/joint_poses.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

std::string Milliseconds(int64_t ns) {
  return absl::StrFormat("%.1f ms", static_cast<double>(ns) / 1e6);
}

}  // namespace

JointPoses::JointPoses(ArmModel arm, const JointPosesOptions& options)
    : options_(options),
      joints_(arm.joints().size()),
      arm_(std::move(arm)),
      times_ns_(std::max<size_t>(options.samples, 2)),
      values_(times_ns_.size() * joints_),
      between_(joints_) {}

absl::Status JointPoses::Push(int64_t time_ns, std::span<const double> values) {
  const std::lock_guard lock(mutex_);
  TACTUS_RETURN_IF_ERROR(arm_.Check(values));
  if (time_ns > limits::kMaxCaptureTimeNs ||
      time_ns < -limits::kMaxCaptureTimeNs) {
    return InvalidConfig(
        "time of the joint values", time_ns,
        absl::StrCat("nanoseconds, at most ", limits::kMaxCaptureTimeNs));
  }
  if (count_ > 0 && time_ns <= TimeOf(count_ - 1)) {
    return InvalidConfig(
        "time of the joint values", time_ns,
        absl::StrCat("above that of the values before, ", TimeOf(count_ - 1)));
  }
  if (count_ == times_ns_.size()) {
    first_ = Slot(1);
    --count_;
  }
  const size_t slot = Slot(count_++);
  times_ns_[slot] = time_ns;
  std::ranges::copy(values, &values_[slot * joints_]);
  return absl::OkStatus();
}

std::optional<Pose> JointPoses::PoseAt(int64_t time_ns) {
  const std::lock_guard lock(mutex_);
  reason_ = Reason::kNone;
  if (count_ == 0) return Fail(Reason::kNoSamples, 0);
  const int64_t oldest_ns = TimeOf(0);
  if (time_ns < oldest_ns) {
    // The difference of any two times might overflow.
    const int64_t by_ns = time_ns < -limits::kMaxCaptureTimeNs
                              ? limits::kMaxCaptureTimeNs
                              : oldest_ns - time_ns;
    return Fail(Reason::kTooOld, by_ns);
  }
  if (time_ns > TimeOf(count_ - 1)) return PoseAhead(time_ns);
  // The first sample that is not before `time_ns`.
  size_t low = 0;
  size_t high = count_ - 1;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (TimeOf(middle) < time_ns) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  if (TimeOf(low) == time_ns) return PoseOnLine(low, low, time_ns);
  return PoseOnLine(low - 1, low, time_ns);
}

std::optional<Pose> JointPoses::PoseAhead(int64_t time_ns) {
  const size_t newest = count_ - 1;
  if (time_ns > limits::kMaxCaptureTimeNs) {
    return Fail(Reason::kTooNew, limits::kMaxCaptureTimeNs);
  }
  const int64_t ahead_ns = time_ns - TimeOf(newest);
  if (ahead_ns > options_.max_ahead_ns) return Fail(Reason::kTooNew, ahead_ns);
  for (size_t base = newest; base-- > 0;) {
    if (TimeOf(newest) - TimeOf(base) >= ahead_ns) {
      return PoseOnLine(base, newest, time_ns);
    }
  }
  return Fail(Reason::kFewSamples, 0);
}

std::optional<Pose> JointPoses::PoseOnLine(size_t a, size_t b,
                                           int64_t time_ns) {
  const int64_t gap_ns = TimeOf(b) - TimeOf(a);
  if (gap_ns > options_.max_gap_ns) return Fail(Reason::kGap, gap_ns);
  const double t = a == b ? 0
                          : static_cast<double>(time_ns - TimeOf(a)) /
                                static_cast<double>(gap_ns);
  arm_.Interpolate(ValuesOf(a), ValuesOf(b), t, between_);
  const Pose pose = arm_.Forward(between_);
  // The server refuses such a pose, and with it the stream.
  if (!(pose.position.norm() <= limits::kMaxPositionM)) {
    return Fail(Reason::kTooFar, 0);
  }
  return pose;
}

std::optional<Pose> JointPoses::Fail(Reason reason, int64_t by_ns) {
  reason_ = reason;
  by_ns_ = by_ns;
  return std::nullopt;
}

std::string JointPoses::Problem() const {
  const std::lock_guard lock(mutex_);
  switch (reason_) {
    case Reason::kNone:
      return "";
    case Reason::kNoSamples:
      return "no joint values have come";
    case Reason::kFewSamples:
      return "too few joint values have come";
    case Reason::kTooNew:
      return absl::StrCat("the newest joint values are ", Milliseconds(by_ns_),
                          " older than the frame; at most ",
                          Milliseconds(options_.max_ahead_ns), " is bridged");
    case Reason::kTooOld:
      return absl::StrCat("the frame is ", Milliseconds(by_ns_),
                          " older than the oldest joint values that are kept");
    case Reason::kGap:
      return absl::StrCat("joint values are ", Milliseconds(by_ns_),
                          " apart; at most ", Milliseconds(options_.max_gap_ns),
                          " is bridged");
    case Reason::kTooFar:
      return absl::StrCat("the skin would be more than ", limits::kMaxPositionM,
                          " m from the base");
  }
  return "";
}

}  // namespace tactus::internal::client
