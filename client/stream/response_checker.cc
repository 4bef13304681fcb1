#include "client/stream/response_checker.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/limits_questions.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

using google::protobuf::RepeatedField;

// How far the sum of probabilities may be from 1.
constexpr double kSumTolerance = 1e-3;

absl::Status CheckRange(absl::string_view field, double value, double low,
                        double high) {
  if (value >= low && value <= high) return absl::OkStatus();
  return InvalidResponse(field, value, absl::StrCat(low, " to ", high));
}

absl::Status CheckFinite(absl::string_view field, double value) {
  if (std::isfinite(value)) return absl::OkStatus();
  return InvalidResponse(field, value, "finite");
}

absl::Status CheckCount(absl::string_view field, int got, int want) {
  if (got == want) return absl::OkStatus();
  return InvalidResponse(absl::StrCat("size of ", field), got,
                         absl::StrCat(want, ", one per class or value"));
}

absl::Status CheckDistribution(absl::string_view field,
                               const RepeatedField<double>& values,
                               int classes) {
  TACTUS_RETURN_IF_ERROR(CheckCount(field, values.size(), classes));
  double sum = 0;
  for (const double value : values) {
    TACTUS_RETURN_IF_ERROR(CheckRange(field, value, 0, 1));
    sum += value;
  }
  return CheckRange(absl::StrCat("sum of ", field), sum, 1 - kSumTolerance,
                    1 + kSumTolerance);
}

// A class whose models exclude the contact has the logarithm of 0.
absl::Status CheckLogLikelihood(const RepeatedField<double>& values,
                                int classes) {
  constexpr absl::string_view kField = "diagnostics.log_likelihood";
  TACTUS_RETURN_IF_ERROR(CheckCount(kField, values.size(), classes));
  for (const double value : values) {
    if (std::isnan(value) || value == std::numeric_limits<double>::infinity()) {
      return InvalidResponse(kField, value, "finite or -inf");
    }
  }
  return absl::OkStatus();
}

absl::Status CheckScores(const v1::Answer& answer, int classes) {
  if (!answer.has_diagnostics()) return absl::OkStatus();
  const auto& all = answer.diagnostics().contacts();
  if (all.size() != answer.contacts_size()) {
    return InvalidResponse(
        "size of diagnostics.contacts", all.size(),
        absl::StrCat(answer.contacts_size(), ", one per contact"));
  }
  for (const v1::ContactScores& scores : all) {
    TACTUS_RETURN_IF_ERROR(
        CheckLogLikelihood(scores.log_likelihood(), classes));
    TACTUS_RETURN_IF_ERROR(CheckDistribution(
        "diagnostics.hmm_probability", scores.hmm_probability(), classes));
    if (!scores.lstm_probability().empty()) {
      TACTUS_RETURN_IF_ERROR(CheckDistribution(
          "diagnostics.lstm_probability", scores.lstm_probability(), classes));
    }
    TACTUS_RETURN_IF_ERROR(
        CheckRange("diagnostics.stability", scores.stability(), 0, 1));
  }
  return absl::OkStatus();
}

absl::Status CheckVector(absl::string_view field, const v1::Vector3& vector) {
  for (const double value : {vector.x(), vector.y(), vector.z()}) {
    TACTUS_RETURN_IF_ERROR(CheckFinite(field, value));
  }
  return absl::OkStatus();
}

absl::Status CheckPlace(const v1::SkinPlace& place) {
  TACTUS_RETURN_IF_ERROR(CheckVector("contact.patch's link", place.link()));
  TACTUS_RETURN_IF_ERROR(
      CheckVector("contact.patch's link_normal", place.link_normal()));
  TACTUS_RETURN_IF_ERROR(CheckVector("contact.patch's world", place.world()));
  return CheckVector("contact.patch's world_normal", place.world_normal());
}

absl::Status CheckPatch(const v1::Contact& contact, int taxels) {
  if (!contact.has_patch()) return absl::OkStatus();
  const v1::ContactPatch& patch = contact.patch();
  for (const double value : {patch.force(), patch.max_force(), patch.area_m2(),
                             patch.centroid_row(), patch.centroid_column()}) {
    TACTUS_RETURN_IF_ERROR(CheckFinite("contact.patch", value));
  }
  TACTUS_RETURN_IF_ERROR(
      CheckRange("contact.patch.area_taxels", patch.area_taxels(), 1, taxels));
  TACTUS_RETURN_IF_ERROR(CheckRange("size of contact.patch.taxels",
                                    patch.taxels_size(), 0, taxels));
  for (const uint32_t taxel : patch.taxels()) {
    TACTUS_RETURN_IF_ERROR(
        CheckRange("contact.patch.taxels", taxel, 0, taxels - 1));
  }
  TACTUS_RETURN_IF_ERROR(CheckPlace(patch.centroid()));
  return CheckPlace(patch.centre_of_pressure());
}

absl::Status CheckDecision(const v1::QuestionAnswer& answer,
                           uint64_t sequence) {
  if (!answer.has_decision()) return absl::OkStatus();
  const v1::Decision& decision = answer.decision();
  TACTUS_RETURN_IF_ERROR(CheckRange("decision.value", decision.value(), 0,
                                    answer.probability_size() - 1));
  for (const uint64_t at : {decision.sequence(), decision.changed_sequence()}) {
    if (at > sequence) {
      return InvalidResponse(
          "sequence of a decision", at,
          absl::StrCat("at most answer.sequence, ", sequence));
    }
  }
  for (const int64_t time : {decision.time_since_onset_ns(),
                             decision.changed_time_since_onset_ns()}) {
    if (time < 0) {
      return InvalidResponse("time_since_onset_ns of a decision", time,
                             "at least 0");
    }
  }
  return absl::OkStatus();
}

absl::Status CheckObject(const v1::Contact& contact) {
  if (!contact.has_object()) return absl::OkStatus();
  const v1::ObjectEstimate& object = contact.object();
  for (const double value : {object.log10_stiffness(), object.moved_m()}) {
    TACTUS_RETURN_IF_ERROR(CheckFinite("contact.object", value));
  }
  for (const double value :
       {object.log10_stiffness_deviation(), object.moved_deviation_m()}) {
    TACTUS_RETURN_IF_ERROR(CheckRange("contact.object's deviations", value, 0,
                                      std::numeric_limits<double>::max()));
  }
  return absl::OkStatus();
}

// True if some contact of the answer has this id.
bool HasContact(const v1::Answer& answer, uint64_t id) {
  return std::ranges::any_of(answer.contacts(), [id](const auto& contact) {
    return contact.id() == id;
  });
}

}  // namespace

void ResponseChecker::OnSent(const v1::ClassifyContactRequest& request) {
  if (request.has_frames()) {
    const v1::FrameBatch& frames = request.frames();
    const uint64_t last = frames.first_sequence() + frames.frame_count() - 1;
    sent_sequence_ = std::max<uint64_t>(sent_sequence_, last);
  } else if (request.has_end_of_trial()) {
    ++trials_ended_;
  }
}

absl::Status ResponseChecker::Check(
    const v1::ClassifyContactResponse& response) {
  if (response.has_started()) return CheckStarted(response.started());
  if (classes_ == 0) {
    return InvalidResponse("first response", "not `started`", "`started`");
  }
  if (response.has_answer()) return CheckAnswer(response.answer());
  return absl::OkStatus();
}

absl::Status ResponseChecker::CheckStarted(const v1::StreamStarted& started) {
  if (classes_ != 0) {
    return InvalidResponse("number of `started` responses", 2, "1");
  }
  TACTUS_RETURN_IF_ERROR(CheckRange("number of started.class_names",
                                    started.class_names_size(), 1,
                                    limits::kMaxClasses));
  for (const std::string& name : started.class_names()) {
    if (name.empty() || name.size() > limits::kMaxNameBytes) {
      return InvalidResponse("length of a name in started.class_names",
                             name.size(),
                             absl::StrCat("1 to ", limits::kMaxNameBytes));
    }
  }
  const v1::SensorGeometry& geometry = started.geometry();
  TACTUS_RETURN_IF_ERROR(CheckRange("started.geometry.rows", geometry.rows(), 1,
                                    limits::kMaxRows));
  TACTUS_RETURN_IF_ERROR(CheckRange(
      "started.geometry.columns", geometry.columns(), 1, limits::kMaxColumns));
  TACTUS_RETURN_IF_ERROR(CheckQuestions(started));
  classes_ = started.class_names_size();
  taxels_ = static_cast<int>(geometry.rows() * geometry.columns());
  return absl::OkStatus();
}

absl::Status ResponseChecker::CheckQuestions(const v1::StreamStarted& started) {
  TACTUS_RETURN_IF_ERROR(CheckRange("number of started.questions",
                                    started.questions_size(), 1,
                                    limits::kMaxQuestions));
  for (const v1::Question& question : started.questions()) {
    TACTUS_RETURN_IF_ERROR(CheckRange("number of a question's values",
                                      question.values_size(), 1,
                                      started.class_names_size()));
    TACTUS_RETURN_IF_ERROR(CheckCount("question.value_of_class",
                                      question.value_of_class_size(),
                                      started.class_names_size()));
    for (const uint32_t value : question.value_of_class()) {
      TACTUS_RETURN_IF_ERROR(CheckRange("question.value_of_class", value, 0,
                                        question.values_size() - 1));
    }
    values_.push_back(question.values_size());
  }
  return absl::OkStatus();
}

absl::Status ResponseChecker::CheckAnswer(const v1::Answer& answer) {
  TACTUS_RETURN_IF_ERROR(CheckOrder(answer));
  TACTUS_RETURN_IF_ERROR(CheckRange("number of answer.contacts",
                                    answer.contacts_size(), 0,
                                    limits::kMaxContacts));
  for (const v1::Contact& contact : answer.contacts()) {
    TACTUS_RETURN_IF_ERROR(CheckContact(contact, answer.sequence()));
  }
  for (const v1::ContactEvent& event : answer.events()) {
    if (!HasContact(answer, event.contact_id())) {
      return InvalidResponse("event.contact_id", event.contact_id(),
                             "the id of a contact of the answer");
    }
    if (event.question() >= values_.size()) {
      return InvalidResponse("event.question", event.question(),
                             absl::StrCat("below ", values_.size()));
    }
    TACTUS_RETURN_IF_ERROR(CheckRange("event.value", event.value(), 0,
                                      values_[event.question()] - 1));
  }
  return CheckScores(answer, classes_);
}

absl::Status ResponseChecker::CheckContact(const v1::Contact& contact,
                                           uint64_t sequence) {
  if (contact.id() == 0) return InvalidResponse("contact.id", 0, "at least 1");
  if (contact.state() < v1::Contact::STATE_TOUCHING ||
      contact.state() > v1::Contact::STATE_RELEASED) {
    return InvalidResponse("contact.state", static_cast<int>(contact.state()),
                           "a value of Contact.State");
  }
  if (contact.onset_sequence() > sequence) {
    return InvalidResponse("contact.onset_sequence", contact.onset_sequence(),
                           absl::StrCat("at most answer.sequence, ", sequence));
  }
  if (contact.time_since_onset_ns() < 0) {
    return InvalidResponse("contact.time_since_onset_ns",
                           contact.time_since_onset_ns(), "at least 0");
  }
  TACTUS_RETURN_IF_ERROR(CheckPatch(contact, taxels_));
  TACTUS_RETURN_IF_ERROR(CheckFinite("contact.motion_m", contact.motion_m()));
  TACTUS_RETURN_IF_ERROR(CheckDistribution("contact.probability",
                                           contact.probability(), classes_));
  if (contact.answers_size() != static_cast<int>(values_.size())) {
    return InvalidResponse("size of contact.answers", contact.answers_size(),
                           absl::StrCat(values_.size(), ", one per question"));
  }
  for (size_t q = 0; q < values_.size(); ++q) {
    const v1::QuestionAnswer& answer = contact.answers(q);
    TACTUS_RETURN_IF_ERROR(CheckDistribution("contact.answers.probability",
                                             answer.probability(), values_[q]));
    TACTUS_RETURN_IF_ERROR(CheckDecision(answer, sequence));
  }
  TACTUS_RETURN_IF_ERROR(
      CheckRange("contact.unknown", contact.unknown(), 0, 1));
  return CheckObject(contact);
}

absl::Status ResponseChecker::CheckOrder(const v1::Answer& answer) {
  const uint64_t sequence = answer.sequence();
  const uint64_t sent = sent_sequence_;
  if (sequence > sent) {
    return InvalidResponse(
        "answer.sequence", sequence,
        absl::StrCat("at most ", sent, ", the last frame that was sent"));
  }
  if (!answer.is_final()) {
    if (sequence <= last_sequence_) {
      return InvalidResponse("answer.sequence", sequence,
                             absl::StrCat("above ", last_sequence_));
    }
    last_sequence_ = sequence;
    return absl::OkStatus();
  }
  if (sequence < last_sequence_) {
    return InvalidResponse("sequence of a final answer", sequence,
                           absl::StrCat("at least ", last_sequence_));
  }
  last_sequence_ = sequence;
  // The end of a stream may end one trial more.
  const uint64_t most = trials_ended_ + 1;
  if (++finals_ > most) {
    return InvalidResponse("number of final answers", finals_,
                           absl::StrCat("at most ", most));
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal::client
