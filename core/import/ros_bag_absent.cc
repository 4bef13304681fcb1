// ReadBag() in a build without librosbag-storage-dev.
#include "core/base/errors.h"
#include "core/import/ros_bag.h"

namespace tactus::internal {

absl::StatusOr<ArrayFile> ReadBag(const std::string& path, const BagTopics&) {
  return InvalidConfig(path, "a bag of ROS 1",
                       "read by a build with bags: apt-get install "
                       "librosbag-storage-dev, then build again");
}

}  // namespace tactus::internal
