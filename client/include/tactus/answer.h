// File: answer.h
//
// Answer: what is known of a skin's contacts after a frame, by names.
//
//   if (const Contact* contact = answer.main()) {
//     Use(contact->Probability("hardness", "hard"));
//     if (contact->Decided("mobility") == "moved") LetGo();
//   }
//   for (const Event& event : answer.events) Use(ToText(event));
//
// What was not measured is absent, never zero. Plain data, copyable.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tactus {

struct NamedProbability {
  std::string name = {};
  double probability = 0;
};

// The value whose probability stayed high for long enough.
struct DecidedValue {
  std::string value = {};
  // The frame at which the question was decided first, and the time from onset
  // to it.
  uint64_t sequence = 0;
  int64_t since_onset_ns = 0;
  // How often the value has changed since then, and when it did last; 0 if it
  // has not.
  int changes = 0;
  uint64_t changed_sequence = 0;
  int64_t changed_since_onset_ns = 0;
  // The question is about a property that stays, and yet its value changed: one
  // of the two was wrong.
  bool revised = false;
};

// What is known of one of the model's questions.
struct QuestionAnswer {
  std::string question = {};
  // Sum to 1.
  std::vector<NamedProbability> values = {};
  std::optional<DecidedValue> decided = std::nullopt;
};

// A place or a direction.
struct Point3 {
  double x = 0;
  double y = 0;
  double z = 0;
};

// A place on the skin and the outward unit normal there: in the frame of the
// skin's link, and in the world if frames have poses. Metres.
struct SkinSpot {
  Point3 link = {};
  Point3 link_normal = {};
  std::optional<Point3> world = std::nullopt;
  std::optional<Point3> world_normal = std::nullopt;
};

// Where a contact is on the skin, and how hard it presses there.
struct ContactPatch {
  // Sum and largest of the region's taxels, in the skin's unit.
  double force = 0;
  double max_force = 0;
  int area_taxels = 0;
  double area_m2 = 0;
  // The region's centroid by fractional row and column, and as a place.
  double centroid_row = 0;
  double centroid_column = 0;
  SkinSpot centroid = {};
  // The centroid by load; absent if no taxel reads a load at this moment.
  std::optional<SkinSpot> centre_of_pressure = std::nullopt;
  // With StreamOptions::with_taxels: row-major indices, rising.
  std::vector<int> taxels = {};
};

// Estimates of the object that is touched: means and standard deviations.
struct TouchedObject {
  // log10 of its stiffness in N/m.
  double log10_stiffness = 0;
  double log10_stiffness_deviation = 0;
  // Metres that it has moved since onset.
  double moved_m = 0;
  double moved_deviation_m = 0;
};

struct Contact {
  enum class State {
    kTouching,
    // It touches no taxel for the moment.
    kLost,
    // Its region has joined that of the contact `merged_into`.
    kMerged,
    kReleased,
  };

  // Counts the contacts of a stream from 1.
  uint64_t id = 0;
  State state = State::kTouching;
  // The frame at which it began, and the time since then.
  uint64_t onset_sequence = 0;
  int64_t since_onset_ns = 0;
  // Absent unless it touches the skin.
  std::optional<ContactPatch> patch = std::nullopt;
  // Metres that it has moved since its onset; absent after its end.
  std::optional<double> motion_m = std::nullopt;
  // Per class of the model; sum to 1.
  std::vector<NamedProbability> classes = {};
  // Per question of the model.
  std::vector<QuestionAnswer> answers = {};
  // Probability that the model has learned from nothing like this contact.
  double unknown = 0;
  // Absent if the model estimates none.
  std::optional<TouchedObject> object = std::nullopt;
  // The contact of whose region it was a part, and the one that it is merged
  // into; 0 if none.
  uint64_t parent = 0;
  uint64_t merged_into = 0;

  // Probability of a value of a question; 0 if the model has none such.
  double Probability(std::string_view question, std::string_view value) const;
  // The decided value of a question; empty while there is none.
  std::string_view Decided(std::string_view question) const;
};

enum class EventKind {
  kTouched,
  kReleased,
  // A question was decided, or its decided value changed.
  kDecided,
  kChanged,
  // The contact is probably like none that the model has learned from.
  kUnknown,
  // Its region has joined, or parted from, that of `other_contact`.
  kMerged,
  kSplit,
  kMovedOverSkin,
};

struct Event {
  EventKind kind = EventKind::kTouched;
  uint64_t contact = 0;
  // The frame at which it happened, and the contact's time since onset then.
  uint64_t sequence = 0;
  int64_t capture_time_ns = 0;
  int64_t since_onset_ns = 0;
  // Names, for kDecided and kChanged; else empty.
  std::string question = {};
  std::string value = {};
  // For kMerged and kSplit; else 0.
  uint64_t other_contact = 0;
};

// "touched", "released", "decided", "changed", "unknown", "merged", "split",
// "moved over skin".
std::string_view ToText(EventKind kind);

// For people: "120 ms: contact 1 decided hardness: hard".
std::string ToText(const Event& event);

struct Answer {
  // The frame's number and time.
  uint64_t sequence = 0;
  int64_t capture_time_ns = 0;
  // The contacts that there are, and those that ended with this frame, the
  // largest first. In a final answer, those that the end of the trial ended.
  std::vector<Contact> contacts = {};
  // What happened at this frame.
  std::vector<Event> events = {};
  // Regions of touched taxels, also those that are no contact.
  int regions = 0;
  // Frames of this trial that were lost so far.
  uint64_t frames_missing = 0;
  // Interim answers of this stream that a newer one replaced so far.
  uint64_t superseded = 0;
  // The last answer of a trial.
  bool is_final = false;

  // The contact that a robot reads if it wants one; null if there is none.
  const Contact* main() const {
    return contacts.empty() ? nullptr : &contacts.front();
  }
};

}  // namespace tactus
