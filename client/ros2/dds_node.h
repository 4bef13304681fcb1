// File: dds_node.h
//
// DdsNode: topics of ROS 2, by DDS alone, without ROS. Messages are bytes.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto node, DdsNode::Open({.domain = 7}));
//   TACTUS_ASSIGN_OR_RETURN(
//       const auto reader,
//       node->Subscribe("/touch", "std_msgs/msg/UInt16MultiArray",
//                       SensorQos()));
//   TACTUS_ASSIGN_OR_RETURN(
//       const auto writer,
//       node->Advertise("/tactus/event", "tactus_msgs/msg/Event", {}));
//   node->Wait(std::chrono::milliseconds(100));
//   DdsMessage message;
//   while (reader->Take(message)) Use(message.bytes);
//
// The node outlives its readers and writers. Write may be called from any
// thread; everything else belongs to one.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal::client {

// Those of ROS 2 that topics of sensors and robots use; all are volatile.
struct DdsQos {
  bool reliable = true;
  // Messages that are kept: by a reader until they are taken, by a reliable
  // writer until they have arrived.
  int depth = 10;
};

// rmw_qos_profile_sensor_data.
inline DdsQos SensorQos() { return {.reliable = false, .depth = 5}; }

struct DdsMessage {
  // CDR, with the four bytes before it.
  std::string bytes;
  // When it was published, on the publisher's clock: since 1970.
  int64_t published_ns = 0;
};

class DdsReader {
 public:
  virtual ~DdsReader() = default;
  // The oldest message; false if there is none.
  virtual bool Take(DdsMessage& message) = 0;
  // Publishers that match, and the name of the last policy by which one did
  // not; empty if all did.
  virtual int publishers() = 0;
  virtual std::string refused_policy() = 0;
};

class DdsWriter {
 public:
  virtual ~DdsWriter() = default;
  // IO; DEADLINE_EXCEEDED if a reliable reader takes too long.
  virtual absl::Status Write(absl::string_view bytes) = 0;
  virtual int subscribers() = 0;
};

struct DdsNodeOptions {
  // 0 to 232; absent: ROS_DOMAIN_ID, or 0.
  std::optional<int> domain = std::nullopt;
};

class DdsNode {
 public:
  // Takes part in the domain with the configuration of CYCLONEDDS_URI.
  // INVALID_CONFIG for a domain that is none, IO if DDS does not start.
  static absl::StatusOr<std::unique_ptr<DdsNode>> Open(
      const DdsNodeOptions& options);
  virtual ~DdsNode() = default;

  // Names as in ROS 2: "/touch", "std_msgs/msg/UInt16MultiArray".
  // INVALID_CONFIG for a name that is none; IO.
  virtual absl::StatusOr<std::unique_ptr<DdsReader>> Subscribe(
      const std::string& topic, const std::string& type, const DdsQos& qos) = 0;
  virtual absl::StatusOr<std::unique_ptr<DdsWriter>> Advertise(
      const std::string& topic, const std::string& type, const DdsQos& qos) = 0;

  // The type by which somebody publishes the topic; empty if nobody does, or if
  // the type is not one of ROS 2. INVALID_CONFIG for a name that is none.
  virtual absl::StatusOr<std::string> TypeOf(const std::string& topic) = 0;

  // Returns when a reader has a message or a publisher is new, or at the end of
  // this time.
  virtual void Wait(std::chrono::milliseconds limit) = 0;

  virtual int domain() const = 0;
};

}  // namespace tactus::internal::client
