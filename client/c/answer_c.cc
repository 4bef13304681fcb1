// The answers of tactus.h: reads them by index.
#include <limits>

#include "client/c/include/tactus.h"
#include "client/c/structs.h"

namespace tactus::internal::c {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

const Answer* FromC(const tactus_answer* answer) {
  return reinterpret_cast<const Answer*>(answer);
}

const Contact* FromC(const tactus_contact* contact) {
  return reinterpret_cast<const Contact*>(contact);
}

// Null if there is none.
const QuestionAnswer* QuestionOf(const tactus_contact* contact,
                                 size_t question) {
  if (contact == nullptr) return nullptr;
  const auto& answers = FromC(contact)->answers;
  return question < answers.size() ? &answers[question] : nullptr;
}

double ProbabilityAt(const std::vector<NamedProbability>& named, size_t index) {
  return index < named.size() ? named[index].probability : kNone;
}

void WritePoint(const Point3& point, double (&out)[3]) {
  out[0] = point.x;
  out[1] = point.y;
  out[2] = point.z;
}

constexpr Point3 kNowhere = {.x = kNone, .y = kNone, .z = kNone};

}  // namespace
}  // namespace tactus::internal::c

namespace c = tactus::internal::c;

bool tactus_answer_get(const tactus_answer* answer, tactus_answer_info* info) {
  if (answer == nullptr || info == nullptr) return false;
  const tactus::Answer& from = *c::FromC(answer);
  tactus_answer_info full = TACTUS_ANSWER_INFO_INIT;
  full.sequence = from.sequence;
  full.capture_time_ns = from.capture_time_ns;
  full.frames_missing = from.frames_missing;
  full.contacts = from.contacts.size();
  full.regions = from.regions;
  full.is_final = from.is_final;
  c::CopyOut(full, info);
  return true;
}

const tactus_contact* tactus_answer_contact(const tactus_answer* answer,
                                            size_t index) {
  if (answer == nullptr) return nullptr;
  const auto& contacts = c::FromC(answer)->contacts;
  return index < contacts.size()
             ? reinterpret_cast<const tactus_contact*>(&contacts[index])
             : nullptr;
}

bool tactus_contact_get(const tactus_contact* contact,
                        tactus_contact_info* info) {
  if (contact == nullptr || info == nullptr) return false;
  const tactus::Contact& from = *c::FromC(contact);
  tactus_contact_info full = TACTUS_CONTACT_INFO_INIT;
  full.id = from.id;
  full.onset_sequence = from.onset_sequence;
  full.since_onset_ns = from.since_onset_ns;
  full.parent = from.parent;
  full.merged_into = from.merged_into;
  full.unknown = from.unknown;
  full.motion_m = from.motion_m.value_or(c::kNone);
  full.state = static_cast<int32_t>(from.state);
  c::CopyOut(full, info);
  return true;
}

double tactus_contact_probability(const tactus_contact* contact,
                                  size_t class_index) {
  if (contact == nullptr) return c::kNone;
  return c::ProbabilityAt(c::FromC(contact)->classes, class_index);
}

double tactus_contact_value(const tactus_contact* contact, size_t question,
                            size_t value) {
  const tactus::QuestionAnswer* const answer = c::QuestionOf(contact, question);
  return answer == nullptr ? c::kNone : c::ProbabilityAt(answer->values, value);
}

bool tactus_contact_decided(const tactus_contact* contact, size_t question,
                            tactus_decided* decided) {
  const tactus::QuestionAnswer* const answer = c::QuestionOf(contact, question);
  if (answer == nullptr || decided == nullptr || !answer->decided) return false;
  const tactus::DecidedValue& from = *answer->decided;
  tactus_decided full = TACTUS_DECIDED_INIT;
  while (full.value < answer->values.size() &&
         answer->values[full.value].name != from.value) {
    ++full.value;
  }
  full.sequence = from.sequence;
  full.since_onset_ns = from.since_onset_ns;
  full.changed_sequence = from.changed_sequence;
  full.changed_since_onset_ns = from.changed_since_onset_ns;
  full.changes = from.changes;
  full.revised = from.revised;
  c::CopyOut(full, decided);
  return true;
}

bool tactus_contact_patch(const tactus_contact* contact, tactus_patch* patch) {
  if (contact == nullptr || patch == nullptr || !c::FromC(contact)->patch) {
    return false;
  }
  const tactus::ContactPatch& from = *c::FromC(contact)->patch;
  tactus_patch full = TACTUS_PATCH_INIT;
  full.force = from.force;
  full.max_force = from.max_force;
  full.area_m2 = from.area_m2;
  full.centroid_row = from.centroid_row;
  full.centroid_column = from.centroid_column;
  c::WritePoint(from.centroid.link, full.place);
  c::WritePoint(from.centroid.link_normal, full.normal);
  c::WritePoint(from.centroid.world.value_or(c::kNowhere), full.world_place);
  c::WritePoint(
      from.centre_of_pressure ? from.centre_of_pressure->link : c::kNowhere,
      full.centre_of_pressure);
  full.area_taxels = from.area_taxels;
  c::CopyOut(full, patch);
  return true;
}

size_t tactus_contact_taxels(const tactus_contact* contact, int32_t* taxels,
                             size_t capacity) {
  if (contact == nullptr || !c::FromC(contact)->patch) return 0;
  const std::vector<int>& from = c::FromC(contact)->patch->taxels;
  if (taxels != nullptr) {
    std::copy_n(from.begin(), std::min(capacity, from.size()), taxels);
  }
  return from.size();
}

bool tactus_contact_object(const tactus_contact* contact,
                           tactus_object* object) {
  if (contact == nullptr || object == nullptr || !c::FromC(contact)->object) {
    return false;
  }
  const tactus::TouchedObject& from = *c::FromC(contact)->object;
  tactus_object full = TACTUS_OBJECT_INIT;
  full.log10_stiffness = from.log10_stiffness;
  full.log10_stiffness_deviation = from.log10_stiffness_deviation;
  full.moved_m = from.moved_m;
  full.moved_deviation_m = from.moved_deviation_m;
  c::CopyOut(full, object);
  return true;
}
