// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
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

namespace tactus::internal::client::kinematics_examples {

static absl::Status ArmModelExample(const std::string& urdf,
                                    const std::vector<double>& joint_values) {
#include "client/kinematics/arm_model.h.inc"
  return absl::OkStatus();
}

static void JointPosesExample(ArmModel arm, CanBus& bus, CanSkinProtocol& skin,
                              int64_t time_ns,
                              const std::vector<double>& joint_values) {
#include "client/kinematics/joint_poses.h.inc"
}

static absl::Status JointLineExample() {
#include "client/kinematics/joint_line.h.inc"
  return absl::OkStatus();
}

static absl::Status JointReceiverExample(JointPoses& poses) {
#include "client/kinematics/joint_receiver.h.inc"
  return absl::OkStatus();
}

static void SkinPlacesExample(const SkinInfo& info, const v1::Answer& answer,
                              JointPoses& poses) {
#include "client/kinematics/skin_places.h.inc"
}

static absl::Status UrdfTextExample(const std::string& urdf) {
#include "client/kinematics/urdf_text.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::client::kinematics_examples
