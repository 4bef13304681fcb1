// ArmModel::FromUrdf() in a build without urdfdom and KDL.
#include "client/kinematics/arm_model.h"
#include "core/base/errors.h"

namespace tactus::internal::client {

absl::StatusOr<ArmModel> ArmModel::FromUrdf(absl::string_view,
                                            const std::string&) {
  return InvalidConfig("this build", "without urdfdom and KDL",
                       "made with them to read a URDF: apt-get install "
                       "liburdfdom-dev liborocos-kdl-dev, then build again");
}

}  // namespace tactus::internal::client
