#include "client/ros2/link_poses.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/kinematics/joint_poses.h"
#include "client/ros2/skin_topic.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/import/ros2/cdr_reader.h"
#include "core/import/ros2/ros2_taxels.h"
#include "core/import/ros2/ros2_type.h"

namespace tactus::internal::client {
namespace {

// Joints of one message.
constexpr size_t kMaxNames = 10'000;
constexpr char kJointType[] = "sensor_msgs/msg/JointState";
constexpr char kPoseType[] = "geometry_msgs/msg/PoseStamped";
// Times that go back by more begin anew: a clock was set, or a bag is played
// again.
constexpr int64_t kAnewNs = 1'000'000'000;

LinkPose ToLinkPose(const Pose& pose) {
  return {.x = pose.position.x(),
          .y = pose.position.y(),
          .z = pose.position.z(),
          .qx = pose.orientation.x(),
          .qy = pose.orientation.y(),
          .qz = pose.orientation.z(),
          .qw = pose.orientation.w()};
}

struct JointValues {
  int64_t time_ns = 0;
  std::map<std::string, double> values;
};

// Ros2Message keeps one text of a list, so this reads the names itself.
absl::StatusOr<JointValues> ReadJoints(const DdsMessage& message) {
  CdrReader reader(message.bytes);
  JointValues joints;
  const auto seconds = reader.Number<int32_t>();
  const auto rest = reader.Number<uint32_t>();
  joints.time_ns = int64_t{seconds} * 1'000'000'000 + rest;
  if (joints.time_ns == 0) joints.time_ns = message.published_ns;
  reader.Text();
  std::vector<std::string> names;
  for (auto left = reader.Number<uint32_t>(); left > 0 && reader.good();
       --left) {
    if (names.size() == kMaxNames) {
      return TrialFileInvalid(
          kJointType, absl::StrCat("has more than ", kMaxNames, " names"));
    }
    names.emplace_back(reader.Text());
  }
  const auto count = reader.Number<uint32_t>();
  if (reader.good() && count != names.size()) {
    return TrialFileInvalid(
        kJointType,
        absl::StrCat("has ", names.size(), " names and ", count, " positions"));
  }
  for (const std::string& name : names) {
    joints.values[name] = reader.Number<double>();
  }
  if (!reader.good()) return TrialFileInvalid(kJointType, reader.fault());
  return joints;
}

class JointLinkPoses final : public LinkPoses {
 public:
  JointLinkPoses(std::string urdf, std::string skin_link, ArmModel arm,
                 const JointPosesOptions& options)
      : urdf_(std::move(urdf)),
        skin_link_(std::move(skin_link)),
        options_(options) {
    for (const ArmJoint& joint : arm.joints()) names_.push_back(joint.name);
    values_.resize(names_.size());
    poses_.emplace(std::move(arm), options_);
  }

  std::string type() const override { return kJointType; }

  absl::Status Take(const DdsMessage& message) override {
    TACTUS_ASSIGN_OR_RETURN(const JointValues joints, ReadJoints(message));
    bool has_news = false;
    for (size_t i = 0; i < names_.size(); ++i) {
      const auto found = joints.values.find(names_[i]);
      if (found == joints.values.end()) continue;
      values_[i] = found->second;
      has_news = true;
    }
    if (!has_news) return absl::OkStatus();
    std::vector<double> values;
    for (size_t i = 0; i < names_.size(); ++i) {
      if (!values_[i]) {
        unknown_joint_ = names_[i];
        return absl::OkStatus();
      }
      values.push_back(*values_[i]);
    }
    unknown_joint_.clear();
    if (joints.time_ns < last_ns_ - kAnewNs) {
      TACTUS_ASSIGN_OR_RETURN(ArmModel arm,
                              ArmModel::FromUrdf(urdf_, skin_link_));
      poses_.emplace(std::move(arm), options_);
      last_ns_ = 0;
    }
    // Two publishers of joints may have the same time.
    if (joints.time_ns <= last_ns_) return absl::OkStatus();
    TACTUS_RETURN_IF_ERROR(poses_->Push(joints.time_ns, values));
    last_ns_ = joints.time_ns;
    return absl::OkStatus();
  }

  std::optional<LinkPose> PoseAt(int64_t time_ns) override {
    const std::optional<Pose> pose = poses_->PoseAt(time_ns);
    if (!pose) return std::nullopt;
    return ToLinkPose(*pose);
  }

  std::string Problem() const override {
    return unknown_joint_.empty()
               ? poses_->Problem()
               : absl::StrCat("nobody publishes the joint ", unknown_joint_);
  }

 private:
  const std::string urdf_;
  const std::string skin_link_;
  const JointPosesOptions options_;
  // In the order of the chain; values that have come so far.
  std::vector<std::string> names_;
  std::vector<std::optional<double>> values_;
  std::optional<JointPoses> poses_;
  int64_t last_ns_ = 0;
  std::string unknown_joint_;
};

class StampedPoses final : public LinkPoses {
 public:
  StampedPoses(Ros2Type reader, const LinkPosesOptions& options)
      : reader_(std::move(reader)), options_(options) {}

  std::string type() const override { return kPoseType; }

  absl::Status Take(const DdsMessage& message) override {
    TACTUS_ASSIGN_OR_RETURN(const Ros2Message read,
                            reader_.Read(message.bytes));
    TACTUS_ASSIGN_OR_RETURN(const std::vector<double> v, PoseNumbersOf(read));
    const int64_t time_ns = StampOf(read).value_or(message.published_ns);
    if (!poses_.empty() && time_ns < poses_.rbegin()->first - kAnewNs) {
      poses_.clear();
    }
    poses_[time_ns] = {v[0], v[1], v[2], v[3], v[4], v[5], v[6]};
    if (poses_.size() > kMost) poses_.erase(poses_.begin());
    return absl::OkStatus();
  }

  std::optional<LinkPose> PoseAt(int64_t time_ns) override {
    problem_.clear();
    auto after = poses_.upper_bound(time_ns);
    if (after == poses_.begin()) {
      problem_ = poses_.empty() ? "no pose has come"
                                : "all poses are later than the frame";
      return std::nullopt;
    }
    --after;
    if (time_ns - after->first > options_.max_age_ns) {
      problem_ = absl::StrCat("the last pose is ",
                              (time_ns - after->first) / 1'000'000,
                              " ms older than the frame");
      return std::nullopt;
    }
    return after->second;
  }

  std::string Problem() const override { return problem_; }

 private:
  static constexpr size_t kMost = 1'024;

  const Ros2Type reader_;
  const LinkPosesOptions options_;
  std::map<int64_t, LinkPose> poses_;
  std::string problem_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<LinkPoses>> LinkPoses::FromJoints(
    const std::string& urdf, const std::string& skin_link,
    const LinkPosesOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(ArmModel arm, ArmModel::FromUrdf(urdf, skin_link));
  return std::make_unique<JointLinkPoses>(
      urdf, skin_link, std::move(arm),
      JointPosesOptions{.max_gap_ns = 2 * options.max_age_ns,
                        .max_ahead_ns = options.max_age_ns});
}

std::unique_ptr<LinkPoses> LinkPoses::FromPoses(
    const LinkPosesOptions& options) {
  auto reader = Ros2Type::Parse(kPoseType, "");
  return std::make_unique<StampedPoses>(*std::move(reader), options);
}

}  // namespace tactus::internal::client
