#include "client/ros2/touch_messages.h"

#include <algorithm>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/ros2/cdr_writer.h"

namespace tactus::internal::client {
namespace {

constexpr int64_t kNsPerS = 1'000'000'000;

// builtin_interfaces/Time and Duration, whose nanoseconds are never below 0.
void WriteTime(CdrWriter& out, int64_t time_ns) {
  int64_t seconds = time_ns / kNsPerS;
  int64_t rest = time_ns % kNsPerS;
  if (rest < 0) {
    rest += kNsPerS;
    --seconds;
  }
  out.Number<int32_t>(static_cast<int32_t>(seconds));
  out.Number<uint32_t>(static_cast<uint32_t>(rest));
}

void WriteHeader(CdrWriter& out, int64_t time_ns, const std::string& frame_id) {
  WriteTime(out, time_ns);
  out.Text(frame_id);
}

void WritePoint(CdrWriter& out, const Point3& point) {
  out.Number<double>(point.x);
  out.Number<double>(point.y);
  out.Number<double>(point.z);
}

void WriteNamed(CdrWriter& out, const NamedProbability& named) {
  out.Text(named.name);
  out.Number<double>(named.probability);
}

void WriteQuestion(CdrWriter& out, const QuestionAnswer& question) {
  out.Text(question.question);
  out.List(question.values,
           [&](const NamedProbability& each) { WriteNamed(out, each); });
  const DecidedValue decided = question.decided.value_or(DecidedValue{});
  out.Text(decided.value);
  WriteTime(out, decided.since_onset_ns);
  out.Number<uint32_t>(static_cast<uint32_t>(decided.changes));
  out.Number<bool>(decided.revised);
}

void WritePatch(CdrWriter& out, const Contact& contact) {
  const ContactPatch patch = contact.patch.value_or(ContactPatch{});
  out.Number<bool>(contact.patch.has_value());
  out.Number<double>(patch.force);
  out.Number<double>(patch.max_force);
  out.Number<uint32_t>(static_cast<uint32_t>(patch.area_taxels));
  out.Number<double>(patch.area_m2);
  out.Number<double>(patch.centroid_row);
  out.Number<double>(patch.centroid_column);
  WritePoint(out, patch.centroid.link);
  WritePoint(out, patch.centroid.link_normal);
  WritePoint(out, patch.centre_of_pressure.value_or(patch.centroid).link);
  out.Number<bool>(patch.centroid.world.has_value());
  WritePoint(out, patch.centroid.world.value_or(Point3{}));
}

void WriteContact(CdrWriter& out, const Contact& contact) {
  out.Number<uint64_t>(contact.id);
  out.Number<uint8_t>(static_cast<uint8_t>(contact.state));
  out.Number<uint64_t>(contact.onset_sequence);
  WriteTime(out, contact.since_onset_ns);
  WritePatch(out, contact);
  out.Number<double>(
      contact.motion_m.value_or(std::numeric_limits<double>::quiet_NaN()));
  out.List(contact.classes,
           [&](const NamedProbability& each) { WriteNamed(out, each); });
  out.List(contact.answers,
           [&](const QuestionAnswer& each) { WriteQuestion(out, each); });
  out.Number<double>(contact.unknown);
  const TouchedObject object = contact.object.value_or(TouchedObject{});
  out.Number<bool>(contact.object.has_value());
  out.Number<double>(object.log10_stiffness);
  out.Number<double>(object.log10_stiffness_deviation);
  out.Number<double>(object.moved_m);
  out.Number<double>(object.moved_deviation_m);
  out.Number<uint64_t>(contact.parent);
  out.Number<uint64_t>(contact.merged_into);
}

// The most probable class; null if there is none.
const NamedProbability* Best(const Contact& contact) {
  const auto best = std::ranges::max_element(contact.classes, {},
                                             &NamedProbability::probability);
  return best == contact.classes.end() ? nullptr : &*best;
}

// What all markers of a message have.
struct MarkerFrame {
  int64_t time_ns = 0;
  const std::string& frame_id;
  double lifetime_s = 0;
};

// Types of visualization_msgs/Marker.
constexpr int32_t kArrow = 0;
constexpr int32_t kText = 9;

// Metres: the arrow of a contact that is sure, and the text beyond its end.
constexpr double kArrowLength = 0.1;
constexpr double kTextDistance = 0.13;

Point3 Along(const Point3& from, const Point3& direction, double length) {
  return {from.x + length * direction.x, from.y + length * direction.y,
          from.z + length * direction.z};
}

// Red for a probability of 0, green for 1.
void WriteColour(CdrWriter& out, double probability) {
  out.Number<float>(static_cast<float>(1 - probability));
  out.Number<float>(static_cast<float>(probability));
  out.Number<float>(0.1F);
  out.Number<float>(1);
}

void WriteMarker(CdrWriter& out, const MarkerFrame& frame,
                 const Contact& contact, int32_t type, const Point3& position,
                 const Point3& scale, const std::vector<Point3>& points,
                 const std::string& text) {
  WriteHeader(out, frame.time_ns, frame.frame_id);
  out.Text(type == kText ? "tactus_classes" : "tactus_contacts");
  out.Number<int32_t>(static_cast<int32_t>(contact.id));
  out.Number<int32_t>(type);
  out.Number<int32_t>(0);
  WritePoint(out, position);
  for (const double each : {0.0, 0.0, 0.0, 1.0}) out.Number<double>(each);
  WritePoint(out, scale);
  WriteColour(out, Best(contact)->probability);
  WriteTime(out, static_cast<int64_t>(frame.lifetime_s * kNsPerS));
  out.Number<bool>(false);
  out.List(points, [&](const Point3& point) { WritePoint(out, point); });
  out.EmptyList();
  // No texture: its resource, the image, and places in it.
  out.Text("");
  WriteHeader(out, 0, "");
  out.Text("");
  out.EmptyList();
  out.EmptyList();
  out.Text(text);
  // No mesh: its resource, the file, and whether its materials are used.
  out.Text("");
  out.Text("");
  out.EmptyList();
  out.Number<bool>(false);
}

void WriteArrow(CdrWriter& out, const Contact& contact,
                const MarkerFrame& frame) {
  const SkinSpot& spot = contact.patch->centroid;
  const double length = kArrowLength * Best(contact)->probability;
  // Diameters of the shaft and of the head, and the length of the head.
  WriteMarker(out, frame, contact, kArrow, {}, {0.006, 0.014, 0.02},
              {Along(spot.link, spot.link_normal, length), spot.link}, "");
}

void WriteLabel(CdrWriter& out, const Contact& contact,
                const MarkerFrame& frame) {
  const SkinSpot& spot = contact.patch->centroid;
  const NamedProbability& best = *Best(contact);
  WriteMarker(out, frame, contact, kText,
              Along(spot.link, spot.link_normal, kTextDistance), {0, 0, 0.03},
              {},
              absl::StrFormat("%s %.0f %%", best.name, 100 * best.probability));
}

}  // namespace

std::string ContactsMessage(const Answer& answer, const std::string& frame_id) {
  CdrWriter out;
  WriteHeader(out, answer.capture_time_ns, frame_id);
  out.Number<uint64_t>(answer.sequence);
  out.List(answer.contacts,
           [&](const Contact& contact) { WriteContact(out, contact); });
  out.Number<uint32_t>(static_cast<uint32_t>(answer.regions));
  out.Number<uint64_t>(answer.frames_missing);
  out.Number<bool>(answer.is_final);
  return out.bytes();
}

std::string EventMessage(const Event& event, const std::string& frame_id) {
  CdrWriter out;
  WriteHeader(out, event.capture_time_ns, frame_id);
  out.Number<uint64_t>(event.sequence);
  out.Number<uint8_t>(static_cast<uint8_t>(event.kind));
  out.Number<uint64_t>(event.contact);
  WriteTime(out, event.since_onset_ns);
  out.Text(event.question);
  out.Text(event.value);
  out.Number<uint64_t>(event.other_contact);
  return out.bytes();
}

std::string MarkersMessage(const Answer& answer, const std::string& frame_id,
                           double lifetime_s) {
  CdrWriter out;
  std::vector<const Contact*> shown;
  for (const Contact& contact : answer.contacts) {
    if (contact.patch && Best(contact) != nullptr) shown.push_back(&contact);
  }
  out.Number<uint32_t>(static_cast<uint32_t>(2 * shown.size()));
  for (const Contact* const contact : shown) {
    WriteArrow(out, *contact, {answer.capture_time_ns, frame_id, lifetime_s});
    WriteLabel(out, *contact, {answer.capture_time_ns, frame_id, lifetime_s});
  }
  return out.bytes();
}

std::string DiagnosticsMessage(const Diagnosis& diagnosis, int64_t time_ns) {
  CdrWriter out;
  WriteHeader(out, time_ns, "");
  out.Number<uint32_t>(1);
  out.Number<uint8_t>(static_cast<uint8_t>(diagnosis.level));
  out.Text(diagnosis.name);
  out.Text(diagnosis.message);
  out.Text(diagnosis.hardware_id);
  out.List(diagnosis.values, [&](const auto& value) {
    out.Text(value.first);
    out.Text(value.second);
  });
  return out.bytes();
}

}  // namespace tactus::internal::client
