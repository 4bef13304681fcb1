// File: front_frames.h
//
// A skin, frames and records of what came back, for tests of the public
// streams. Test-only.
//
//   Record record;
//   auto stream = client.Open(CodySkin(), record.Options());
//   stream->Push(CodyFrame(1, Touch(2)));
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "tactus/stream.h"
#include "tests/server/support/requests.h"

namespace tactus::internal::testing {

inline Skin CodySkin() { return {.name = "cody-forearm", .scale = kStep}; }

// Captured as the frames of requests.h.
inline Frame CodyFrame(uint64_t sequence, const Counts& counts) {
  Frame frame;
  frame.capture_time_ns = static_cast<int64_t>(sequence) * 10'000'000;
  frame.values.assign(counts.begin(), counts.end());
  return frame;
}

// What a stream gave; thread-safe.
class Record {
 public:
  // Without on_event: events are polled.
  StreamOptions Options(const std::string& model = "") {
    StreamOptions options = {.model = model};
    options.on_answer = [this](const Answer& answer) {
      const std::lock_guard lock(mutex_);
      answers_.push_back(answer);
    };
    return options;
  }
  StreamOptions OptionsWithEvents(const std::string& model = "") {
    StreamOptions options = Options(model);
    options.on_event = [this](const Event& event) {
      const std::lock_guard lock(mutex_);
      events_.push_back(ToText(event));
    };
    return options;
  }
  std::vector<Answer> answers() {
    const std::lock_guard lock(mutex_);
    return answers_;
  }
  std::vector<std::string> events() {
    const std::lock_guard lock(mutex_);
    return events_;
  }

 private:
  std::mutex mutex_;
  std::vector<Answer> answers_;
  std::vector<std::string> events_;
};

inline std::vector<std::string> PollAll(Stream& stream) {
  std::vector<std::string> events;
  for (Event event; stream.Poll(event);) events.push_back(ToText(event));
  return events;
}

// Every number of an answer, exactly, but `superseded`.
inline std::string AllOf(const Answer& answer) {
  std::string text;
  const auto add = [&](const auto& value) { text += absl::StrCat(value, " "); };
  const auto number = [&](double value) {
    text += absl::StrFormat("%a ", value);
  };
  const auto point = [&](const Point3& p) {
    number(p.x), number(p.y), number(p.z);
  };
  const auto spot = [&](const SkinSpot& s) {
    point(s.link), point(s.link_normal);
    if (s.world) point(*s.world), point(*s.world_normal);
  };
  add(answer.sequence), add(answer.capture_time_ns), add(answer.regions);
  add(answer.frames_missing), add(answer.is_final);
  for (const tactus::Contact& contact : answer.contacts) {
    add(contact.id), add(static_cast<int>(contact.state));
    add(contact.onset_sequence), add(contact.since_onset_ns);
    if (contact.patch) {
      const ContactPatch& patch = *contact.patch;
      number(patch.force), number(patch.max_force), add(patch.area_taxels);
      number(patch.area_m2), number(patch.centroid_row);
      number(patch.centroid_column), spot(patch.centroid);
      if (patch.centre_of_pressure) spot(*patch.centre_of_pressure);
      for (const int taxel : patch.taxels) add(taxel);
    }
    if (contact.motion_m) number(*contact.motion_m);
    for (const NamedProbability& named : contact.classes) {
      add(named.name), number(named.probability);
    }
    for (const QuestionAnswer& question : contact.answers) {
      add(question.question);
      for (const NamedProbability& named : question.values) {
        add(named.name), number(named.probability);
      }
      if (!question.decided) continue;
      add(question.decided->value), add(question.decided->sequence);
      add(question.decided->since_onset_ns), add(question.decided->changes);
      add(question.decided->changed_sequence);
      add(question.decided->changed_since_onset_ns);
      add(question.decided->revised);
    }
    number(contact.unknown);
    if (contact.object) {
      number(contact.object->log10_stiffness);
      number(contact.object->log10_stiffness_deviation);
      number(contact.object->moved_m);
      number(contact.object->moved_deviation_m);
    }
    add(contact.parent), add(contact.merged_into);
  }
  for (const Event& event : answer.events) add(ToText(event));
  return text;
}

}  // namespace tactus::internal::testing
