// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/drivers/can_skin_driver.h"
#include "client/kinematics/arm_model.h"
#include "client/kinematics/joint_line.h"
#include "client/kinematics/joint_poses.h"
#include "client/kinematics/joint_receiver.h"
#include "client/kinematics/skin_places.h"
#include "client/kinematics/urdf_text.h"
#include "core/base/status_macros.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::client::kinematics_examples {

absl::Status ArmModelExample(const std::string& urdf,
                             const std::vector<double>& joint_values) {
  TACTUS_ASSIGN_OR_RETURN(ArmModel arm,
                          ArmModel::FromUrdf(urdf, "forearm_skin"));
  TACTUS_ASSIGN_OR_RETURN(const Pose pose, arm.PoseOf(joint_values));
  return absl::OkStatus();
}

void JointPosesExample(ArmModel arm, CanBus& bus, CanSkinProtocol& skin,
                       int64_t time_ns,
                       const std::vector<double>& joint_values) {
  JointPoses poses(std::move(arm));
  CanSkinDriver driver(&bus, &skin,
                       {.pose_at = [&](int64_t t) { return poses.PoseAt(t); },
                        .pose_problem = [&] { return poses.Problem(); }});
  const absl::Status pushed = poses.Push(time_ns, joint_values);
}

absl::Status JointLineExample() {
  int64_t time_ns = 0;
  std::vector<double> values(7);
  TACTUS_RETURN_IF_ERROR(
      ParseJointLine("0 0.1 -1.2 0 1.5 0 0.7 0", time_ns, values));
  return absl::OkStatus();
}

absl::Status JointReceiverExample(JointPoses& poses) {
  TACTUS_ASSIGN_OR_RETURN(const auto receiver,
                          JointReceiver::Listen("127.0.0.1:5005", &poses));
  return absl::OkStatus();
}

void SkinPlacesExample(const SkinInfo& info, const v1::Posterior& posterior,
                       JointPoses& poses) {
  const SkinPlaces places(info.layout);
  const v1::ContactFeatures& features = posterior.features();
  const std::optional<Pose> pose = poses.PoseAt(posterior.capture_time_ns());
  if (pose) {
    const Eigen::Vector3d place = places.InWorld(
        {features.centroid_row(), features.centroid_column()}, *pose);
  }
}

absl::Status UrdfTextExample(const std::string& urdf) {
  TACTUS_RETURN_IF_ERROR(CheckUrdfText(urdf));
  return absl::OkStatus();
}

}  // namespace tactus::client::kinematics_examples
