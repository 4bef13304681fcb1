#include "tools/common/arm_source.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/files/file_bytes.h"

namespace tactus::internal::client {

absl::StatusOr<std::unique_ptr<ArmSource>> ArmSource::Make(
    const ArmSourceOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(const std::string urdf,
                          ReadFileBytes(options.urdf, limits::kMaxUrdfBytes));
  auto arm = ArmModel::FromUrdf(urdf, options.skin_link);
  if (!arm.ok()) return Annotate(arm.status(), options.urdf);
  std::unique_ptr<ArmSource> source(
      new ArmSource(*std::move(arm), options.joints));
  auto receiver = JointReceiver::Listen(options.joints, &source->poses_);
  if (!receiver.ok()) return Annotate(receiver.status(), "--joints");
  source->receiver_ = *std::move(receiver);
  return source;
}

HardwareDriverOptions ArmSource::DriverOptions() {
  return {.pose_at = [this](int64_t time_ns) { return PoseAt(time_ns); },
          .pose_problem = [this] { return Problem(); }};
}

std::string ArmSource::Problem() const {
  const JointReceiver::Statistics received = receiver_->statistics();
  return received.refusing ? received.last_refusal : poses_.Problem();
}

std::string ArmSource::Usage() const {
  return absl::StrCat("joint values at ", address_, " as: time_ns ",
                      absl::StrReplaceAll(poses_.JointNames(), {{", ", " "}}));
}

std::string ArmSource::Summary() const {
  const JointReceiver::Statistics s = receiver_->statistics();
  return absl::StrCat(
      "joint samples: ", s.taken, " taken, ", s.refused, " refused",
      s.last_refusal.empty() ? "" : ", the last: ", s.last_refusal);
}

}  // namespace tactus::internal::client
