// File: touch_messages.h
//
// What is known of contacts, as messages of ROS 2: those of the package
// tactus_msgs (client/ros2/tactus_msgs), markers for RViz, diagnostics.
//
//   TACTUS_RETURN_IF_ERROR(
//       contacts.Write(ContactsMessage(answer, "forearm_skin")));
//   for (const Event& event : answer.events) {
//     TACTUS_RETURN_IF_ERROR(
//         events.Write(EventMessage(event, "forearm_skin")));
//   }
//
// Stamps are the frames' times, since 1970. Messages are CDR (cdr_writer.h).
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tactus/answer.h"

namespace tactus::internal::client {

inline constexpr char kContactsType[] = "tactus_msgs/msg/Contacts";
inline constexpr char kEventType[] = "tactus_msgs/msg/ContactEvent";
inline constexpr char kMarkersType[] = "visualization_msgs/msg/MarkerArray";
inline constexpr char kDiagnosticsType[] =
    "diagnostic_msgs/msg/DiagnosticArray";

// `frame_id` names the link that carries the skin.
std::string ContactsMessage(const Answer& answer, const std::string& frame_id);
std::string EventMessage(const Event& event, const std::string& frame_id);

// For each contact that touches the skin an arrow onto its place, which is as
// long as it is sure, and a text. They vanish after `lifetime_s`.
std::string MarkersMessage(const Answer& answer, const std::string& frame_id,
                           double lifetime_s);

struct Diagnosis {
  enum class Level : uint8_t { kOk = 0, kWarning = 1, kError = 2, kStale = 3 };

  Level level = Level::kOk;
  // "tactus-ros2: /touch".
  std::string name = {};
  // What is wrong, or that all is well.
  std::string message = {};
  std::string hardware_id = {};
  std::vector<std::pair<std::string, std::string>> values = {};
};

std::string DiagnosticsMessage(const Diagnosis& diagnosis, int64_t time_ns);

}  // namespace tactus::internal::client
