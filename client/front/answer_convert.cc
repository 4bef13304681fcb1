#include "client/front/answer_convert.h"

#include <algorithm>
#include <limits>

#include "absl/strings/str_cat.h"
#include "client/stream/frame_encoder.h"
#include "client/stream/skin_notice_text.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

Contact::State ToState(v1::Contact::State state) {
  switch (state) {
    case v1::Contact::STATE_LOST:
      return Contact::State::kLost;
    case v1::Contact::STATE_MERGED:
      return Contact::State::kMerged;
    case v1::Contact::STATE_RELEASED:
      return Contact::State::kReleased;
    default:
      return Contact::State::kTouching;
  }
}

EventKind ToKind(v1::ContactEvent::Kind kind) {
  switch (kind) {
    case v1::ContactEvent::KIND_RELEASED:
      return EventKind::kReleased;
    case v1::ContactEvent::KIND_DECIDED:
      return EventKind::kDecided;
    case v1::ContactEvent::KIND_CHANGED:
      return EventKind::kChanged;
    case v1::ContactEvent::KIND_UNKNOWN:
      return EventKind::kUnknown;
    case v1::ContactEvent::KIND_MERGED:
      return EventKind::kMerged;
    case v1::ContactEvent::KIND_SPLIT:
      return EventKind::kSplit;
    case v1::ContactEvent::KIND_MOVED_OVER_SKIN:
      return EventKind::kMovedOverSkin;
    default:
      return EventKind::kTouched;
  }
}

// A kind of a newer contract has no name here.
bool IsKnown(v1::ContactEvent::Kind kind) {
  return kind != v1::ContactEvent::KIND_UNSPECIFIED &&
         v1::ContactEvent::Kind_IsValid(kind);
}

Point3 ToPoint(const v1::Vector3& from) {
  return {.x = from.x(), .y = from.y(), .z = from.z()};
}

SkinSpot ToSpot(const v1::SkinPlace& from) {
  SkinSpot spot;
  spot.link = ToPoint(from.link());
  spot.link_normal = ToPoint(from.link_normal());
  if (from.has_world()) {
    spot.world = ToPoint(from.world());
    spot.world_normal = ToPoint(from.world_normal());
  }
  return spot;
}

void ConvertPatch(const v1::ContactPatch& from, ContactPatch& to) {
  to.force = from.force();
  to.max_force = from.max_force();
  to.area_taxels = static_cast<int>(from.area_taxels());
  to.area_m2 = from.area_m2();
  to.centroid_row = from.centroid_row();
  to.centroid_column = from.centroid_column();
  to.centroid = ToSpot(from.centroid());
  to.centre_of_pressure.reset();
  if (from.has_centre_of_pressure()) {
    to.centre_of_pressure = ToSpot(from.centre_of_pressure());
  }
  to.taxels.assign(from.taxels().begin(), from.taxels().end());
}

std::optional<TouchedObject> ToObject(const v1::Contact& contact) {
  if (!contact.has_object()) return std::nullopt;
  const v1::ObjectEstimate& from = contact.object();
  return TouchedObject{
      .log10_stiffness = from.log10_stiffness(),
      .log10_stiffness_deviation = from.log10_stiffness_deviation(),
      .moved_m = from.moved_m(),
      .moved_deviation_m = from.moved_deviation_m()};
}

void ConvertNamed(const std::vector<std::string>& names,
                  const google::protobuf::RepeatedField<double>& from,
                  std::vector<NamedProbability>& to) {
  to.resize(from.size());
  for (int i = 0; i < from.size(); ++i) {
    to[i].name = names[i];
    to[i].probability = from.Get(i);
  }
}

// Zero does not stand for "absent" here.
absl::StatusOr<uint32_t> ToCount(const char* field, int64_t value) {
  if (value >= 0 && value <= std::numeric_limits<uint32_t>::max()) {
    return static_cast<uint32_t>(value);
  }
  return InvalidConfig(field, value, "0 or more");
}

void SetCadence(const StreamOptions& options, uint32_t interval,
                v1::StreamConfig& config) {
  if (options.cadence == Cadence::kOnChange) {
    config.set_cadence(v1::RESULT_CADENCE_ON_CHANGE);
  } else if (options.cadence == Cadence::kEvents) {
    config.set_cadence(v1::RESULT_CADENCE_EVENTS);
  } else if (interval != 1) {
    config.set_cadence(v1::RESULT_CADENCE_EVERY_N_FRAMES);
    config.set_result_interval_frames(interval);
  } else {
    config.set_cadence(v1::RESULT_CADENCE_EVERY_FRAME);
  }
}

}  // namespace

AnswerConverter::AnswerConverter(const v1::StreamStarted& started) {
  info_.model_version = started.model_version();
  info_.model_sha256 = started.bundle_sha256();
  info_.classes.assign(started.class_names().begin(),
                       started.class_names().end());
  for (const v1::Question& question : started.questions()) {
    info_.questions.push_back(
        {.name = question.name(),
         .is_state = question.kind() == v1::Question::KIND_STATE,
         .values = {question.values().begin(), question.values().end()}});
  }
  info_.rows = static_cast<int>(started.geometry().rows());
  info_.columns = static_cast<int>(started.geometry().columns());
  // On the wire, 0 means 1.
  info_.axes = std::max(1, static_cast<int>(started.geometry().axes()));
  info_.max_contacts = static_cast<int>(started.limits().max_contacts());
}

void AnswerConverter::Convert(const v1::Answer& from, Answer& to) const {
  to.sequence = from.sequence();
  to.capture_time_ns = from.capture_time_ns();
  to.regions = static_cast<int>(from.region_count());
  to.frames_missing = from.frames_missing();
  to.superseded = from.superseded();
  to.is_final = from.is_final();
  to.contacts.resize(from.contacts_size());
  for (int i = 0; i < from.contacts_size(); ++i) {
    ConvertContact(from.contacts(i), to.contacts[i]);
  }
  to.events.resize(from.events_size());
  size_t count = 0;
  for (const v1::ContactEvent& event : from.events()) {
    if (IsKnown(event.kind())) ConvertEvent(from, event, to.events[count++]);
  }
  to.events.resize(count);
}

void AnswerConverter::ConvertContact(const v1::Contact& from,
                                     Contact& to) const {
  to.id = from.id();
  to.state = ToState(from.state());
  to.onset_sequence = from.onset_sequence();
  to.since_onset_ns = from.time_since_onset_ns();
  if (from.has_patch()) {
    if (!to.patch) to.patch.emplace();
    ConvertPatch(from.patch(), *to.patch);
  } else {
    to.patch.reset();
  }
  to.motion_m.reset();
  if (from.has_motion_m()) to.motion_m = from.motion_m();
  ConvertNamed(info_.classes, from.probability(), to.classes);
  to.answers.resize(from.answers_size());
  for (int q = 0; q < from.answers_size(); ++q) {
    ConvertQuestion(q, from.answers(q), to.answers[q]);
  }
  to.unknown = from.unknown();
  to.object = ToObject(from);
  to.parent = from.parent_id();
  to.merged_into = from.merged_into();
}

void AnswerConverter::ConvertQuestion(size_t question,
                                      const v1::QuestionAnswer& from,
                                      QuestionAnswer& to) const {
  const QuestionInfo& info = info_.questions[question];
  to.question = info.name;
  ConvertNamed(info.values, from.probability(), to.values);
  if (!from.has_decision()) {
    to.decided.reset();
    return;
  }
  const v1::Decision& decision = from.decision();
  if (!to.decided) to.decided.emplace();
  to.decided->value = info.values[decision.value()];
  to.decided->sequence = decision.sequence();
  to.decided->since_onset_ns = decision.time_since_onset_ns();
  to.decided->changes = static_cast<int>(decision.changes());
  to.decided->changed_sequence = decision.changed_sequence();
  to.decided->changed_since_onset_ns = decision.changed_time_since_onset_ns();
  to.decided->revised = decision.revised();
}

void AnswerConverter::ConvertEvent(const v1::Answer& answer,
                                   const v1::ContactEvent& from,
                                   Event& to) const {
  to.kind = ToKind(from.kind());
  to.contact = from.contact_id();
  to.sequence = answer.sequence();
  to.capture_time_ns = answer.capture_time_ns();
  to.since_onset_ns = 0;
  for (const v1::Contact& contact : answer.contacts()) {
    if (contact.id() != from.contact_id()) continue;
    to.since_onset_ns = contact.time_since_onset_ns();
  }
  to.question.clear();
  to.value.clear();
  if (to.kind == EventKind::kDecided || to.kind == EventKind::kChanged) {
    const QuestionInfo& info = info_.questions[from.question()];
    to.question = info.name;
    to.value = info.values[from.value()];
  }
  to.other_contact = from.other_id();
}

std::optional<Notice> ToNotice(const v1::StreamNotice& notice) {
  switch (notice.kind()) {
    case v1::StreamNotice::KIND_DRAINING:
      return Notice{.kind = Notice::Kind::kDraining,
                    .text = absl::StrCat("the server shuts down within ",
                                         notice.grace_ms(), " ms")};
    case v1::StreamNotice::KIND_MODEL_SUPERSEDED:
      return Notice{.kind = Notice::Kind::kModelSuperseded,
                    .text = "the server has a newer version of the model"};
    case v1::StreamNotice::KIND_RATE_DIFFERS:
      return Notice{
          .kind = Notice::Kind::kRateDiffers,
          .text = absl::StrCat("frames come at ", notice.measured_rate_hz(),
                               " Hz by their capture times, not at ",
                               notice.stated_rate_hz())};
    case v1::StreamNotice::KIND_SKIN_DIFFERS:
      return Notice{.kind = Notice::Kind::kSkinDiffers,
                    .text = SkinNoticeText(notice)};
    default:
      return std::nullopt;
  }
}

absl::StatusOr<v1::StreamConfig> ToConfig(const SkinInfo& skin,
                                          const StreamOptions& options) {
  v1::StreamConfig config = MakeConfig(skin);
  config.set_model(options.model);
  config.set_client_id(options.client_id);
  TACTUS_ASSIGN_OR_RETURN(const uint32_t interval,
                          ToCount("interval_frames", options.interval_frames));
  SetCadence(options, interval, config);
  if (options.decision_threshold) {
    config.set_decision_threshold(*options.decision_threshold);
  }
  if (options.decision_frames) {
    TACTUS_ASSIGN_OR_RETURN(
        const uint32_t frames,
        ToCount("decision_frames", *options.decision_frames));
    config.set_decision_frames(frames);
  }
  if (options.release_after) {
    TACTUS_ASSIGN_OR_RETURN(
        const uint32_t release,
        ToCount("release_after", options.release_after->count()));
    config.set_release_after_ms(release);
  }
  config.set_never_release(options.never_release);
  if (options.max_contacts) {
    TACTUS_ASSIGN_OR_RETURN(const uint32_t most,
                            ToCount("max_contacts", *options.max_contacts));
    config.set_max_contacts(most);
  }
  config.set_effort(options.low_effort ? v1::EFFORT_LOW : v1::EFFORT_FULL);
  config.set_with_taxels(options.with_taxels);
  return config;
}

}  // namespace tactus::internal::client
