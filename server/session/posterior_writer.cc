#include "server/session/posterior_writer.h"

#include <span>

namespace tactus::server {
namespace {

using google::protobuf::RepeatedField;

void Assign(std::span<const double> values, RepeatedField<double>* field) {
  field->Clear();
  field->Add(values.begin(), values.end());
}

v1::ContactState ToProto(ContactState state) {
  switch (state) {
    case ContactState::kNoContact:
      return v1::CONTACT_STATE_NO_CONTACT;
    case ContactState::kInContact:
      return v1::CONTACT_STATE_IN_CONTACT;
    case ContactState::kReleased:
      return v1::CONTACT_STATE_RELEASED;
  }
  return v1::CONTACT_STATE_UNSPECIFIED;
}

void WriteObject(const std::optional<ObjectEstimate>& object,
                 v1::Posterior* posterior) {
  if (!object) {
    if (posterior->has_object()) posterior->clear_object();
    return;
  }
  v1::ObjectEstimate* out = posterior->mutable_object();
  out->set_log10_stiffness(object->log10_stiffness);
  out->set_log10_stiffness_deviation(object->log10_stiffness_deviation);
  out->set_moved_m(object->moved_m);
  out->set_moved_deviation_m(object->moved_deviation_m);
}

void WriteFeatures(const FrameFeatures& features, v1::ContactFeatures* out) {
  out->set_max_force(features.max_force);
  out->set_area_taxels(features.area_taxels);
  out->set_area_m2(features.area_m2);
  out->set_motion_m(features.motion_m);
  out->set_region_count(features.region_count);
  out->set_centroid_row(features.centroid.row);
  out->set_centroid_column(features.centroid.column);
}

}  // namespace

void PosteriorWriter::OnFrame(const ContactReport& report, uint64_t sequence,
                              int64_t capture_time_ns,
                              uint64_t missing_before) {
  sequence_ = sequence;
  capture_time_ns_ = capture_time_ns;
  frames_missing_ += missing_before;
  if (report.onset) {
    has_onset_ = true;
    onset_sequence_ = sequence;
    onset_time_ns_ = capture_time_ns;
  }
  if (report.decided) {
    decision_sequence_ = sequence;
    decision_time_ns_ = capture_time_ns;
  }
}

void PosteriorWriter::OnEndOfTrial() {
  has_onset_ = false;
  frames_missing_ = 0;
}

void PosteriorWriter::Write(const ContactPipeline& pipeline, bool is_final,
                            v1::Posterior* posterior) const {
  const ContactReport& report = pipeline.report();
  const ContactClassifier& classifier = pipeline.classifier();
  posterior->set_sequence(sequence_);
  posterior->set_capture_time_ns(capture_time_ns_);
  posterior->set_contact_state(ToProto(report.state));
  posterior->set_contact_id(report.contact_id);
  posterior->set_onset_sequence(has_onset_ ? onset_sequence_ : 0);
  posterior->set_time_since_onset_ns(
      has_onset_ ? capture_time_ns_ - onset_time_ns_ : 0);
  Assign(classifier.log_likelihood(), posterior->mutable_log_likelihood());
  Assign(classifier.probability(), posterior->mutable_probability());
  Assign(classifier.hmm_probability(), posterior->mutable_hmm_probability());
  Assign(classifier.lstm_probability(), posterior->mutable_lstm_probability());
  posterior->set_unknown(classifier.unknown());
  posterior->set_stability(classifier.stability());
  WriteObject(classifier.object(), posterior);
  WriteDecision(pipeline, posterior);
  if (with_features_) {
    WriteFeatures(report.features, posterior->mutable_features());
  }
  posterior->set_frames_missing(frames_missing_);
  posterior->set_is_final(is_final);
  posterior->set_is_contact_end(!is_final && report.released);
}

void PosteriorWriter::WriteDecision(const ContactPipeline& pipeline,
                                    v1::Posterior* posterior) const {
  const std::optional<Decision>& decision = pipeline.classifier().decision();
  if (!decision) {
    if (posterior->has_decision()) posterior->clear_decision();
    return;
  }
  v1::Decision* out = posterior->mutable_decision();
  out->set_class_index(decision->class_index);
  out->set_sequence(decision_sequence_);
  out->set_time_since_onset_ns(decision_time_ns_ - onset_time_ns_);
}

}  // namespace tactus::server
