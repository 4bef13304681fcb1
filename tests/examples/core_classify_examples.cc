// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "core/bundle/field_count.h"
#include "core/bundle/model_proto.h"
#include "core/classify/calibration.h"
#include "core/classify/compiled_model.h"
#include "core/classify/contact_classifier.h"
#include "core/classify/contact_pipeline.h"
#include "core/classify/input_spec.h"
#include "core/classify/model.h"
#include "core/classify/object_estimate.h"
#include "core/classify/skip_rules.h"
#include "core/classify/step_clock.h"
#include "core/classify/step_savings.h"
#include "core/classify/warm_up.h"
#include "core/hmm/hmm_bank.h"

namespace tactus::examples {

void BundleExample(const std::string& bytes) {
  auto model = DecodeBundle(bytes);  // a flipped byte anywhere is an error
  ContactClassifier classifier(*model, {});
}

void FieldCountExample(const std::string& bytes) {
  if (!HasAtMostFields(*v1::ModelBundle::descriptor(), bytes, 1000)) return;
}

void ContactClassifierExample(std::shared_ptr<const CompiledModel> model,
                              std::span<const ContactSample> contact) {
  ContactClassifier classifier(model, {});
  for (const ContactSample& sample : contact) classifier.Step(sample, 0);
  classifier.probability();
}

void ContactPipelineExample(const SkinLayout& layout,
                            std::shared_ptr<const CompiledModel> model,
                            std::span<const FrameView> frames) {
  auto pipeline = ContactPipeline::Create(layout, model, {});
  for (const FrameView& frame : frames) {
    const ContactReport& report = (*pipeline)->Step(frame);
  }
  (*pipeline)->EndTrial();
}

absl::Status SkipRulesExample(const SkinLayout& layout,
                              std::shared_ptr<const CompiledModel> model) {
  ContactPipeline::Options options;
  options.skip[SkipRule::kUnchangedFrames] = false;
  TACTUS_ASSIGN_OR_RETURN(auto pipeline,
                          ContactPipeline::Create(layout, model, options));
  pipeline->skipped()[SkipRule::kUntouchedFrames];
  return absl::OkStatus();
}

void StepSavingsExample(std::shared_ptr<const CompiledModel> model) {
  ContactClassifier::Options options;
  options.savings = {
      .settled_probability = 0.98, .settled_steps = 4, .settled_stride = 4};
  ContactClassifier classifier(model, options);
}

void CalibrationExample(const Calibration& calibration, double frames,
                        std::span<const double> log_prior,
                        std::span<const double> log_likelihood,
                        std::span<double> hmm, std::span<const double> lstm,
                        std::span<double> bias, std::span<double> fused) {
  const CalibrationPoint point = CalibrationAt(calibration, frames);
  BiasAt(calibration.hmm_bias, point, bias);
  TemperedPosterior(log_prior, log_likelihood, point.hmm_inverse_temperature,
                    bias, hmm);
  FusePosteriors(hmm, lstm, point, bias, fused);
}

absl::Status CompiledModelExample(Model plain) {
  TACTUS_ASSIGN_OR_RETURN(auto model, CompiledModel::Create(std::move(plain)));
  ContactClassifier classifier(model, {});
  return absl::OkStatus();
}

void InputSpecExample(const Model& model, CueTracker& cues,
                      std::span<double> input, BankFilter& hmms) {
  MakeInput(model.inputs.hmm, cues, input);
  hmms.Step(input);
}

absl::Status ModelExample(const Model& model) {
  TACTUS_RETURN_IF_ERROR(Validate(model));
  TACTUS_ASSIGN_OR_RETURN(auto compiled, CompiledModel::Create(model));
  return absl::OkStatus();
}

void ObjectEstimateExample(const double* mean, const double* deviation,
                           double motion_m) {
  const ObjectEstimate estimate = DecodeEstimate(mean, deviation, motion_m);
  estimate.moved_m;
}

void StepClockExample(const Model& model, bool in_contact, BankFilter& hmms,
                      std::span<const double> input) {
  StepClock clock(model.inputs.hmm_steps);
  for (uint64_t frames = 1; in_contact; ++frames) {
    if (clock.Tick(frames)) hmms.Step(input);
  }
  clock.Reset();  // before the next contact
}

absl::Status WarmUpExample(Model model,
                           const std::vector<ContactSample>& samples) {
  model.warm_up.samples = samples;
  TACTUS_RETURN_IF_ERROR(AnswerWarmUp(model));
  return absl::OkStatus();
}

}  // namespace tactus::examples
