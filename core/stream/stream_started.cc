#include "core/stream/stream_started.h"

#include <string>

#include "core/base/limits.h"
#include "core/classify/contact_pipeline.h"
#include "core/classify/input_spec.h"
#include "core/skin/layout_proto.h"

namespace tactus::internal {
namespace {

v1::Question QuestionToProto(const Question& question) {
  v1::Question out;
  out.set_name(question.name);
  out.set_kind(question.kind == Question::kState ? v1::Question::KIND_STATE
                                                 : v1::Question::KIND_PROPERTY);
  for (const std::string& value : question.values) out.add_values(value);
  for (const int value : question.value_of_class) {
    out.add_value_of_class(static_cast<uint32_t>(value));
  }
  return out;
}

}  // namespace

void WriteStarted(const StreamSettings& settings, const CompiledModel& compiled,
                  v1::StreamStarted* started) {
  const Model& model = compiled.model();
  for (const std::string& name : model.class_names) {
    started->add_class_names(name);
  }
  for (const Question& question : compiled.questions()) {
    *started->add_questions() = QuestionToProto(question);
  }
  for (const Feature feature : FeaturesUsed(model.inputs)) {
    started->add_features(std::string(FeatureName(feature)));
  }
  v1::StreamLimits* limits = started->mutable_limits();
  limits->set_max_frames_per_message(limits::kMaxFramesPerMessage);
  limits->set_max_message_bytes(limits::kMaxMessageBytes);
  limits->set_max_contacts(MostContacts(model, settings.pipeline));
  *started->mutable_geometry() = LayoutToProto(settings.layout);
  if (!model.layout.name.empty()) {
    *started->mutable_trained_geometry() = LayoutToProto(model.layout);
  }
  started->set_truth(model.truth == Truth::kSoFar ? v1::TRUTH_SO_FAR
                                                  : v1::TRUTH_FINAL);
}

}  // namespace tactus::internal
