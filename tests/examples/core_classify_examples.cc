// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "core/bundle/field_count.h"
#include "core/bundle/learner_proto.h"
#include "core/bundle/model_proto.h"
#include "core/classify/calibration.h"
#include "core/classify/compiled_model.h"
#include "core/classify/contact_classifier.h"
#include "core/classify/contact_pipeline.h"
#include "core/classify/course_watch.h"
#include "core/classify/input_spec.h"
#include "core/classify/model.h"
#include "core/classify/object_estimate.h"
#include "core/classify/skip_rules.h"
#include "core/classify/step_clock.h"
#include "core/classify/step_savings.h"
#include "core/classify/warm_up.h"
#include "core/hmm/hmm_bank.h"

namespace tactus::internal::examples {

static void BundleExample(const std::string& bytes) {
#include "core/bundle/bundle.h.inc"
}

static absl::Status LearnerProtoExample(Model& model, v1::ModelBundle& bundle) {
#include "core/bundle/learner_proto.h.inc"
  return absl::OkStatus();
}

static void FieldCountExample(const std::string& bytes) {
#include "core/bundle/field_count.h.inc"
}

static void ContactClassifierExample(std::shared_ptr<const CompiledModel> model,
                                     std::span<const ContactSample> contact) {
#include "core/classify/contact_classifier.h.inc"
}

void Look(const ContactSample& sample);

static void CourseWatchExample(std::span<const ContactSample> contact) {
#include "core/classify/course_watch.h.inc"
}

void Use(uint64_t contact_id, int best_class);

static void ContactPipelineExample(const SkinLayout& layout,
                                   std::shared_ptr<const CompiledModel> model,
                                   std::span<const FrameView> frames) {
#include "core/classify/contact_pipeline.h.inc"
}

static absl::Status SkipRulesExample(
    const SkinLayout& layout, std::shared_ptr<const CompiledModel> model) {
#include "core/classify/skip_rules.h.inc"
  return absl::OkStatus();
}

static void StepSavingsExample(std::shared_ptr<const CompiledModel> model) {
#include "core/classify/step_savings.h.inc"
}

static void CalibrationExample(const Calibration& calibration, double frames,
                               std::span<const double> log_prior,
                               std::span<const double> log_likelihood,
                               std::span<double> hmm,
                               std::span<const double> lstm,
                               std::span<double> bias,
                               std::span<double> fused) {
#include "core/classify/calibration.h.inc"
}

static absl::Status CompiledModelExample(Model plain) {
#include "core/classify/compiled_model.h.inc"
  return absl::OkStatus();
}

static void InputSpecExample(const Model& model, CueTracker& cues,
                             std::span<double> input, BankFilter& hmms) {
#include "core/classify/input_spec.h.inc"
}

static absl::Status ModelExample(const Model& model) {
#include "core/classify/model.h.inc"
  return absl::OkStatus();
}

static void ObjectEstimateExample(const double* mean, const double* deviation,
                                  double motion_m) {
#include "core/classify/object_estimate.h.inc"
}

static void StepClockExample(const Model& model, bool in_contact,
                             BankFilter& hmms, std::span<const double> input) {
#include "core/classify/step_clock.h.inc"
}

static absl::Status WarmUpExample(Model model,
                                  const std::vector<ContactSample>& samples) {
#include "core/classify/warm_up.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::examples
