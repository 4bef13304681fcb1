// File: ros2_taxels.h
//
// The taxels of one message of ROS 2: which of its numbers they are, and how
// they lie.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const Ros2Taxels taxels,
//       TaxelsOf("std_msgs/msg/Float32MultiArray", message, ""));
//   taxels.shape;  // {16, 24}: rows, columns
//
// Thread-safe: free functions without state.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/import/ros2/ros2_type.h"

namespace tactus::internal {

struct Ros2Taxels {
  // The field that they are, for bag_values of a skin.json.
  std::string field;
  // As the message says: {numbers}, {rows, columns}, {rows, columns, 3} or, for
  // x, y and z, {taxels, 3}.
  std::vector<size_t> shape;
  std::vector<double> numbers;
  // Numbers of a taxel: 3 if the field has x, y and z, or the message states
  // three dimensions, the last one of length 3.
  size_t axes = 1;
};

// `field` is the path of a field of numbers, or of one with the fields x, y and
// z, which become the three axes of a taxel. Empty: data, magnetic_field,
// sensors.values, sensors.taxels, taxels, values or forces, or else the only
// list that there is. Of a sensor_msgs/msg/Image the pixels, if its encoding
// has one number each. TRIAL_FILE_INVALID names the fields that there are.
absl::StatusOr<Ros2Taxels> TaxelsOf(const std::string& type,
                                    const Ros2Message& message,
                                    const std::string& field);

// x y z qx qy qz qw of a message with position and orientation, perhaps within
// `pose`. TRIAL_FILE_INVALID.
absl::StatusOr<std::vector<double>> PoseNumbersOf(const Ros2Message& message);

}  // namespace tactus::internal
