#include "core/stream/answer_writer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "core/questions/decision_tracker.h"
#include "core/skin/geometry.h"

namespace tactus::internal {
namespace {

using google::protobuf::RepeatedField;
using v1::Contact;
using v1::ContactEvent;

void Assign(std::span<const double> values, RepeatedField<double>* field) {
  field->Clear();
  field->Add(values.begin(), values.end());
}

void WriteVector(const Eigen::Vector3d& vector, v1::Vector3* out) {
  out->set_x(vector.x());
  out->set_y(vector.y());
  out->set_z(vector.z());
}

void WriteObject(const std::optional<ObjectEstimate>& object,
                 Contact* contact) {
  if (!object) {
    if (contact->has_object()) contact->clear_object();
    return;
  }
  v1::ObjectEstimate* out = contact->mutable_object();
  out->set_log10_stiffness(object->log10_stiffness);
  out->set_log10_stiffness_deviation(object->log10_stiffness_deviation);
  out->set_moved_m(object->moved_m);
  out->set_moved_deviation_m(object->moved_deviation_m);
}

Contact::State StateOf(const ContactReport& report) {
  switch (report.phase) {
    case TouchPhase::kInContact:
      return report.features->touched ? Contact::STATE_TOUCHING
                                      : Contact::STATE_LOST;
    case TouchPhase::kMerged:
      return Contact::STATE_MERGED;
    case TouchPhase::kReleased:
      return Contact::STATE_RELEASED;
  }
  return Contact::STATE_UNSPECIFIED;
}

void WriteScores(const ContactClassifier& classifier,
                 v1::ContactScores* scores) {
  Assign(classifier.log_likelihood(), scores->mutable_log_likelihood());
  Assign(classifier.hmm_probability(), scores->mutable_hmm_probability());
  Assign(classifier.lstm_probability(), scores->mutable_lstm_probability());
  scores->set_stability(classifier.stability());
}

}  // namespace

AnswerWriter::AnswerWriter(const StreamSettings* settings)
    : settings_(settings) {}

void AnswerWriter::OnFrame(const ContactPipeline& pipeline,
                           const FrameView& frame, uint64_t sequence,
                           int64_t capture_time_ns) {
  sequence_ = sequence;
  capture_time_ns_ = capture_time_ns;
  frames_missing_ += frame.missing_before;
  has_pose_ = frame.pose != nullptr;
  if (has_pose_) pose_ = *frame.pose;
  event_count_ = 0;
  for (const ContactReport& report : pipeline.contacts()) {
    if (report.onset) Begin(report);
    FindEvents(report);
  }
}

void AnswerWriter::OnEndOfTrial() {
  frames_missing_ = 0;
  event_count_ = 0;
}

void AnswerWriter::Begin(const ContactReport& report) {
  Past& past = past_[report.slot];
  past = {};
  past.onset_sequence = sequence_;
  past.onset_time_ns = capture_time_ns_;
  past.place = report.features->centroid;
  AddEvent(ContactEvent::KIND_TOUCHED, report.id);
  if (report.parent != 0) {
    AddEvent(ContactEvent::KIND_SPLIT, report.id).set_other_id(report.parent);
  }
}

void AnswerWriter::FindEvents(const ContactReport& report) {
  Past& past = past_[report.slot];
  if (report.merged_into != past.merged_into) {
    if (past.merged_into != 0) {
      AddEvent(ContactEvent::KIND_SPLIT, report.id)
          .set_other_id(past.merged_into);
    }
    if (report.merged_into != 0) {
      AddEvent(ContactEvent::KIND_MERGED, report.id)
          .set_other_id(report.merged_into);
    }
    past.merged_into = report.merged_into;
  }
  if (report.released()) {
    AddEvent(ContactEvent::KIND_RELEASED, report.id);
    return;
  }
  const bool is_unknown =
      report.classifier->unknown() >= DecisionTracker::kUnknown;
  if (is_unknown && !past.was_unknown) {
    AddEvent(ContactEvent::KIND_UNKNOWN, report.id);
  }
  past.was_unknown = is_unknown;
  FindDecisions(report);
  FindTravel(report);
}

void AnswerWriter::FindDecisions(const ContactReport& report) {
  Past& past = past_[report.slot];
  const auto decisions = report.classifier->decisions();
  for (size_t q = 0; q < decisions.size(); ++q) {
    const DecisionEvent what =
        EventAt(decisions[q], report.classifier->frames());
    if (what == DecisionEvent::kNone) continue;
    const bool first = what == DecisionEvent::kDecided;
    (first ? past.decided_time_ns : past.changed_time_ns)[q] = capture_time_ns_;
    ContactEvent& event = AddEvent(
        first ? ContactEvent::KIND_DECIDED : ContactEvent::KIND_CHANGED,
        report.id);
    event.set_question(q);
    event.set_value(decisions[q].value);
  }
}

void AnswerWriter::FindTravel(const ContactReport& report) {
  const FrameFeatures& features = *report.features;
  if (!features.touched || !report.felt) return;
  const SkinLayout& layout = settings_->layout;
  Past& past = past_[report.slot];
  // The width of the region, and of a taxel.
  const double size = std::max(
      {std::sqrt(features.area_m2), layout.row_pitch_m, layout.column_pitch_m});
  if (SkinDistance(layout, features.centroid, past.place) <= size) return;
  past.place = features.centroid;
  AddEvent(ContactEvent::KIND_MOVED_OVER_SKIN, report.id);
}

ContactEvent& AnswerWriter::AddEvent(ContactEvent::Kind kind,
                                     uint64_t contact_id) {
  if (event_count_ == events_.size()) events_.emplace_back();
  ContactEvent& event = events_[event_count_++];
  event.Clear();
  event.set_kind(kind);
  event.set_contact_id(contact_id);
  return event;
}

void AnswerWriter::Write(ContactPipeline& pipeline, bool is_final,
                         bool with_taxels, v1::Answer* answer) {
  answer->set_sequence(sequence_);
  answer->set_capture_time_ns(capture_time_ns_);
  answer->set_region_count(pipeline.tracker().regions());
  answer->set_frames_missing(frames_missing_);
  answer->set_is_final(is_final);
  std::array<const ContactReport*, limits::kMaxContacts> shown;
  int count = 0;
  for (const ContactReport& report : pipeline.contacts()) {
    if (!is_final || !report.released()) shown[count++] = &report;
  }
  if (is_final && count == 0 && pipeline.main_contact() != nullptr) {
    shown[count++] = pipeline.main_contact();
  }
  spare_contacts_.Resize(count, answer->mutable_contacts());
  for (int i = 0; i < count; ++i) {
    WriteContact(pipeline, *shown[i], with_taxels, answer->mutable_contacts(i));
  }
  WriteEvents(is_final, answer);
  if (!settings_->with_diagnostics) return;
  auto* scores = answer->mutable_diagnostics()->mutable_contacts();
  spare_scores_.Resize(count, scores);
  for (int i = 0; i < count; ++i) {
    WriteScores(*shown[i]->classifier, scores->Mutable(i));
  }
}

void AnswerWriter::WriteEvents(bool is_final, v1::Answer* answer) {
  auto* events = answer->mutable_events();
  if (!is_final) {
    spare_events_.Resize(static_cast<int>(event_count_), events);
    std::copy_n(events_.begin(), event_count_, events->begin());
    return;
  }
  int count = 0;
  for (const Contact& contact : answer->contacts()) {
    if (contact.state() == Contact::STATE_RELEASED) continue;
    spare_events_.Resize(count + 1, events);
    ContactEvent* event = events->Mutable(count++);
    event->Clear();
    event->set_kind(ContactEvent::KIND_RELEASED);
    event->set_contact_id(contact.id());
  }
  spare_events_.Resize(count, events);
}

void AnswerWriter::WriteContact(ContactPipeline& pipeline,
                                const ContactReport& report, bool with_taxels,
                                Contact* contact) {
  WriteState(report, contact);
  WritePatch(pipeline, report, with_taxels, contact);
  Assign(report.classifier->probability(), contact->mutable_probability());
  WriteAnswers(report, contact);
  contact->set_unknown(report.classifier->unknown());
  WriteObject(report.classifier->object(), contact);
}

void AnswerWriter::WriteState(const ContactReport& report,
                              Contact* contact) const {
  const Past& past = past_[report.slot];
  contact->set_id(report.id);
  contact->set_state(StateOf(report));
  contact->set_onset_sequence(past.onset_sequence);
  contact->set_time_since_onset_ns(capture_time_ns_ - past.onset_time_ns);
  contact->set_parent_id(report.parent);
  contact->set_merged_into(report.merged_into);
  if (report.released()) {
    contact->clear_motion_m();
  } else {
    contact->set_motion_m(report.features->motion_m);
  }
}

void AnswerWriter::WritePatch(ContactPipeline& pipeline,
                              const ContactReport& report, bool with_taxels,
                              Contact* contact) {
  const FrameFeatures& features = *report.features;
  if (!features.touched || report.released()) {
    if (contact->has_patch()) spare_patches_.Keep(contact->release_patch());
    return;
  }
  if (!contact->has_patch()) {
    contact->set_allocated_patch(spare_patches_.Take());
  }
  v1::ContactPatch* patch = contact->mutable_patch();
  patch->set_force(features.net_force);
  patch->set_max_force(features.max_force);
  patch->set_area_taxels(features.area_taxels);
  patch->set_area_m2(features.area_m2);
  patch->set_centroid_row(features.centroid.row);
  patch->set_centroid_column(features.centroid.column);
  WritePlace(features.centroid, patch->mutable_centroid());
  const auto centre = pipeline.tracker().CentreOfPressure(report.slot);
  if (centre) {
    WritePlace(*centre, patch->mutable_centre_of_pressure());
  } else if (patch->has_centre_of_pressure()) {
    patch->clear_centre_of_pressure();
  }
  patch->clear_taxels();
  if (!with_taxels) return;
  const auto rows = pipeline.tracker().RowsOf(report.slot);
  const SkinLayout& layout = settings_->layout;
  for (int row = 0; row < layout.rows; ++row) {
    for (uint64_t rest = rows[row]; rest != 0; rest &= rest - 1) {
      patch->add_taxels(row * layout.columns + std::countr_zero(rest));
    }
  }
}

void AnswerWriter::WritePlace(const SkinPoint& point,
                              v1::SkinPlace* place) const {
  const Eigen::Vector3d link = LinkPosition(settings_->layout, point);
  const Eigen::Vector3d normal = LinkNormal(settings_->layout, point);
  WriteVector(link, place->mutable_link());
  WriteVector(normal, place->mutable_link_normal());
  if (!has_pose_) return;
  WriteVector(pose_.position + pose_.orientation * link,
              place->mutable_world());
  WriteVector(pose_.orientation * normal, place->mutable_world_normal());
}

void AnswerWriter::WriteAnswers(const ContactReport& report, Contact* contact) {
  const Past& past = past_[report.slot];
  const auto decisions = report.classifier->decisions();
  // A model's questions stay the same.
  while (contact->answers_size() < static_cast<int>(decisions.size())) {
    contact->add_answers();
  }
  for (size_t q = 0; q < decisions.size(); ++q) {
    v1::QuestionAnswer* answer = contact->mutable_answers(q);
    Assign(report.classifier->value_probability(q),
           answer->mutable_probability());
    const QuestionDecision& decision = decisions[q];
    if (!decision.decided()) {
      if (answer->has_decision()) {
        spare_decisions_.Keep(answer->release_decision());
      }
      continue;
    }
    if (!answer->has_decision()) {
      answer->set_allocated_decision(spare_decisions_.Take());
    }
    v1::Decision* out = answer->mutable_decision();
    out->set_value(decision.value);
    // Frames since onset are counted with the lost ones, as sequence numbers.
    out->set_sequence(past.onset_sequence + decision.frame - 1);
    out->set_time_since_onset_ns(past.decided_time_ns[q] - past.onset_time_ns);
    out->set_changes(decision.changes);
    const bool changed = decision.changes > 0;
    out->set_changed_sequence(
        changed ? past.onset_sequence + decision.changed_frame - 1 : 0);
    out->set_changed_time_since_onset_ns(
        changed ? past.changed_time_ns[q] - past.onset_time_ns : 0);
    out->set_revised(decision.revised);
  }
}

}  // namespace tactus::internal
