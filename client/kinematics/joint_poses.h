// File: joint_poses.h
//
// JointPoses: the pose of the skin's link at a frame's capture time, from joint
// values that a robot's program pushes as it reads them.
//
//   JointPoses poses(std::move(arm));
//   CanSkinDriver driver(
//       &bus, &skin,
//       {.pose_at = [&](int64_t t) { return poses.PoseAt(t); },
//        .pose_problem = [&] { return poses.Problem(); }});
//   const absl::Status pushed = poses.Push(time_ns, joint_values);
//
// Times are nanoseconds on the clock of the frames, which is CLOCK_MONOTONIC
// for the drivers of real skins. Between two samples the values are
// interpolated linearly. After the newest sample they are continued along a
// straight line for at most `max_ahead_ns`. Otherwise there is no pose, and the
// driver counts the frame as lost: a pose is never invented.
//
// A ring keeps the newest samples. Push and PoseAt allocate nothing but the
// texts of errors. Thread-safe: one thread pushes while the driver's asks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/kinematics/arm_model.h"
#include "core/skin/frame.h"

namespace tactus::internal::client {

struct JointPosesOptions {
  // Samples that are kept, at least 2: a second at 1000 Hz.
  size_t samples = 1024;
  // No pose between two samples that are farther apart.
  int64_t max_gap_ns = 50'000'000;
  // No pose later than this after the newest sample.
  int64_t max_ahead_ns = 20'000'000;
};

class JointPoses {
 public:
  explicit JointPoses(ArmModel arm, const JointPosesOptions& options = {});

  // Takes the values at `time_ns`. INVALID_CONFIG, and the sample is dropped,
  // if ArmModel::Check refuses the values, or if the time is not above that of
  // the sample before or exceeds limits::kMaxCaptureTimeNs.
  absl::Status Push(int64_t time_ns, std::span<const double> values);

  // The pose at `time_ns`, or nothing: then Problem() says why. The line after
  // the newest sample begins at a sample that is at least as far before it as
  // `time_ns` is after it, so that noise is at most tripled.
  std::optional<Pose> PoseAt(int64_t time_ns);

  // Why the last PoseAt returned nothing; empty if it returned a pose.
  std::string Problem() const;

  size_t joints() const { return joints_; }
  // "shoulder, elbow, wrist": the order of the values.
  std::string JointNames() const { return arm_.JointNames(); }

 private:
  enum class Reason {
    kNone,
    kNoSamples,
    kFewSamples,
    kTooNew,
    kTooOld,
    kGap,
    kTooFar
  };

  // Sample `i`, counted from the oldest.
  size_t Slot(size_t i) const { return (first_ + i) % times_ns_.size(); }
  int64_t TimeOf(size_t i) const { return times_ns_[Slot(i)]; }
  std::span<const double> ValuesOf(size_t i) const {
    return {&values_[Slot(i) * joints_], joints_};
  }
  std::optional<Pose> Fail(Reason reason, int64_t by_ns);
  // The pose on the line through samples `a` and `b`.
  std::optional<Pose> PoseOnLine(size_t a, size_t b, int64_t time_ns);
  std::optional<Pose> PoseAhead(int64_t time_ns);

  const JointPosesOptions options_;
  const size_t joints_;

  mutable std::mutex mutex_;
  ArmModel arm_;
  // A ring: `count_` samples from `first_` on.
  std::vector<int64_t> times_ns_;
  // [samples, joints].
  std::vector<double> values_;
  size_t first_ = 0;
  size_t count_ = 0;
  // One value per joint.
  std::vector<double> between_;
  Reason reason_ = Reason::kNone;
  int64_t by_ns_ = 0;
};

}  // namespace tactus::internal::client
