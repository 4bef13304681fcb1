#include "core/import/ros2/ros2_built_in.h"

#include <map>

namespace tactus::internal {
namespace {

constexpr char kArray[] = "MultiArrayLayout layout\n";

std::map<std::string, std::string> MakeTypes() {
  std::map<std::string, std::string> types = {
      {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec"},
      {"builtin_interfaces/Duration", "int32 sec\nuint32 nanosec"},
      {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id"},
      {"std_msgs/Empty", ""},
      {"std_msgs/String", "string data"},
      {"std_msgs/MultiArrayDimension",
       "string label\nuint32 size\nuint32 stride"},
      {"std_msgs/MultiArrayLayout",
       "MultiArrayDimension[] dim\nuint32 data_offset"},
      {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z"},
      {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z"},
      {"geometry_msgs/Quaternion",
       "float64 x\nfloat64 y\nfloat64 z\nfloat64 w"},
      {"geometry_msgs/Pose", "Point position\nQuaternion orientation"},
      {"geometry_msgs/PoseStamped", "std_msgs/Header header\nPose pose"},
      {"geometry_msgs/Wrench", "Vector3 force\nVector3 torque"},
      {"geometry_msgs/WrenchStamped", "std_msgs/Header header\nWrench wrench"},
      {"sensor_msgs/ChannelFloat32", "string name\nfloat32[] values"},
      {"sensor_msgs/Image",
       "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\n"
       "uint8 is_bigendian\nuint32 step\nuint8[] data"},
      {"sensor_msgs/JointState",
       "std_msgs/Header header\nstring[] name\nfloat64[] position\n"
       "float64[] velocity\nfloat64[] effort"},
      {"sensor_msgs/MagneticField",
       "std_msgs/Header header\ngeometry_msgs/Vector3 magnetic_field\n"
       "float64[9] magnetic_field_covariance"},
      {"tactile_msgs/TactileState",
       "std_msgs/Header header\nsensor_msgs/ChannelFloat32[] sensors"}};
  const std::pair<const char*, const char*> arrays[] = {
      {"Float32", "float32"}, {"Float64", "float64"}, {"Int8", "int8"},
      {"Int16", "int16"},     {"Int32", "int32"},     {"Int64", "int64"},
      {"UInt8", "uint8"},     {"UInt16", "uint16"},   {"UInt32", "uint32"},
      {"UInt64", "uint64"}};
  for (const auto& [name, number] : arrays) {
    types[std::string("std_msgs/") + name + "MultiArray"] =
        std::string(kArray) + number + "[] data";
    types[std::string("std_msgs/") + name] = std::string(number) + " data";
  }
  return types;
}

}  // namespace

absl::string_view BuiltInRos2Type(const std::string& name) {
  static const auto* const types =
      new std::map<std::string, std::string>(MakeTypes());
  const auto found = types->find(name);
  if (found == types->end()) return {};
  return found->second;
}

}  // namespace tactus::internal
