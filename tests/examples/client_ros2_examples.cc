// The examples of client/ros2 (tests/examples/CMakeLists.txt).
#include <memory>
#include <string>
#include <vector>

#include "client/ros2/cdr_writer.h"
#include "client/ros2/dds_node.h"
#include "client/ros2/link_poses.h"
#include "client/ros2/raw_type.h"
#include "client/ros2/skin_topic.h"
#include "client/ros2/touch_messages.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client::ros2_examples {

static void CdrWriterExample(int32_t seconds,
                             const std::vector<Contact>& contacts,
                             void (*Write)(const Contact&),
                             void (*Send)(const std::string&)) {
#include "client/ros2/cdr_writer.h.inc"
}

static absl::Status DdsNodeExample(void (*Use)(const std::string&)) {
#include "client/ros2/dds_node.h.inc"
  return absl::OkStatus();
}

static absl::Status LinkPosesExample(const std::string& urdf_text,
                                     const DdsMessage& message, int64_t time_ns,
                                     void (*Use)(const LinkPose&)) {
#include "client/ros2/link_poses.h.inc"
  return absl::OkStatus();
}

static void RawTypeExample(dds_entity_t participant) {
#include "client/ros2/raw_type.h.inc"
}

static absl::Status SkinTopicExample(const SkinFile& skin_file,
                                     const DdsMessage& message,
                                     void (*Push)(const Frame&)) {
#include "client/ros2/skin_topic.h.inc"
  return absl::OkStatus();
}

static absl::Status TouchMessagesExample(DdsWriter& contacts, DdsWriter& events,
                                         const Answer& answer) {
#include "client/ros2/touch_messages.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::client::ros2_examples
