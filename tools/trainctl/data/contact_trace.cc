#include "tools/trainctl/data/contact_trace.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/classify/contact_pipeline.h"
#include "core/classify/input_spec.h"
#include "core/contacts/contact_set.h"
#include "core/contacts/labelled_contact.h"
#include "core/data/trial_id.h"
#include "core/data/trial_layout.h"
#include "core/data/trial_loads.h"
#include "core/features/contact_time.h"
#include "core/features/contact_tracker.h"

namespace tactus::internal::client {
namespace {

void AppendScores(const ContactClassifier& classifier, ContactTrace& trace) {
  const auto probability = classifier.probability();
  for (size_t k = 0; k < trace.probability.size(); ++k) {
    trace.probability[k].push_back(probability[k]);
  }
  trace.unknown.push_back(classifier.unknown());
}

void TakeDecision(const ContactClassifier& classifier, double rate_hz,
                  ContactTrace& trace) {
  if (!classifier.decision()) return;
  trace.decision = {classifier.decision()->class_index,
                    ContactSeconds(classifier.decision()->frame, rate_hz)};
}

// Sets the times of all frames, and the release, from the frame of the onset.
void SetTimes(size_t onset, const std::vector<bool>& touched, double rate_hz,
              ContactTrace& trace) {
  size_t last_touched = onset;
  for (size_t i = 0; i < touched.size(); ++i) {
    trace.time.push_back((static_cast<double>(i) + 1 - onset) / rate_hz);
    if (touched[i]) last_touched = i;
  }
  if (last_touched + 1 < touched.size()) {
    trace.release_s = ContactSeconds(last_touched + 1 - onset, rate_hz);
  }
}

// Runs the frames through `step`, which returns the state after a frame and its
// features.
template <typename Step>
absl::Status TraceFrames(const Trial& trial, const Step& step,
                         ContactTrace& trace) {
  std::optional<size_t> onset;
  std::vector<bool> touched;
  TrialLoads loads(trial.taxels, trace.layout);
  for (size_t i = 0; i < trial.taxels.frames(); ++i) {
    const std::span<const float> taxels = loads.Frame(i);
    FrameView frame{.taxels = loads.values()};
    if (!trial.poses.empty()) frame.pose = &trial.poses[i];
    const std::pair<ContactState, FrameFeatures> now = step(frame);
    if (!onset && now.first == ContactState::kInContact) onset = i;
    touched.push_back(now.second.touched);
    trace.features.push_back(now.second.sample().features);
    trace.frames.emplace_back(taxels.begin(), taxels.end());
  }
  if (!onset) {
    return InvalidConfig(
        absl::StrCat("trial ", trial.id), "never felt",
        absl::StrCat(
            "a trial in which some taxel reaches the onset threshold, ",
            trace.layout.onset_threshold, " ", trace.unit));
  }
  SetTimes(*onset, touched, trial.sample_rate_hz, trace);
  return absl::OkStatus();
}

absl::Status TraceTaxels(const Trial& trial,
                         const std::shared_ptr<const CompiledModel>& model,
                         ContactTrace& trace) {
  if (model == nullptr) {
    ContactTracker tracker(trace.layout,
                           {.sample_rate_hz = trial.sample_rate_hz,
                            .release_after_s = kNeverReleased});
    return TraceFrames(
        trial,
        [&](const FrameView& frame) {
          const FrameFeatures& features = tracker.Step(frame);
          return std::pair(tracker.state(), features);
        },
        trace);
  }
  TACTUS_RETURN_IF_ERROR(CheckSkinOf(trial, trace.layout, model->model()));
  ContactPipeline::Options options;
  options.sample_rate_hz = trial.sample_rate_hz;
  options.with_poses = !trial.poses.empty();
  options.release_after_s = kNeverReleased;
  options.max_contacts = 1;
  TACTUS_ASSIGN_OR_RETURN(
      auto pipeline, ContactPipeline::Create(trace.layout, model, options));
  const ContactClassifier before(model, {});
  TACTUS_RETURN_IF_ERROR(TraceFrames(
      trial,
      [&](const FrameView& frame) {
        const auto contacts = pipeline->Step(frame);
        if (contacts.empty()) {
          AppendScores(before, trace);
          return std::pair(ContactState::kNoContact, FrameFeatures());
        }
        AppendScores(*contacts[0].classifier, trace);
        return std::pair(ContactState::kInContact, *contacts[0].features);
      },
      trace));
  TakeDecision(*pipeline->main_contact()->classifier, trial.sample_rate_hz,
               trace);
  return absl::OkStatus();
}

absl::Status TraceSignals(const Trial& trial,
                          const std::shared_ptr<const CompiledModel>& model,
                          ContactTrace& trace) {
  trace.features = trial.signals;
  // The touch of an ideal signal begins with its first sample.
  SetTimes(0, std::vector<bool>(trial.signals.size(), true),
           trial.sample_rate_hz, trace);
  if (model == nullptr) return absl::OkStatus();
  if (NeedsSkin(model->model())) {
    return InvalidConfig(absl::StrCat("trial ", trial.id), "ideal signals",
                         "taxels: the model sees the whole skin");
  }
  ContactClassifier classifier(model, {});
  for (const FeatureVector& signals : trial.signals) {
    classifier.Step(IdealSample(signals), 0);
    AppendScores(classifier, trace);
  }
  TakeDecision(classifier, trial.sample_rate_hz, trace);
  return absl::OkStatus();
}

}  // namespace

int ContactTrace::Answer() const {
  const auto last_is_less = [](const auto& a, const auto& b) {
    return a.back() < b.back();
  };
  return static_cast<int>(std::ranges::max_element(probability, last_is_less) -
                          probability.begin());
}

absl::StatusOr<ContactTrace> TraceContact(
    const Trial& trial, const SkinLayout& given,
    const std::shared_ptr<const CompiledModel>& model) {
  ContactTrace trace;
  trace.id = TrialName(trial.id, trial.source);
  trace.label = trial.label;
  trace.condition = trial.condition;
  trace.unit = trial.unit == "newton" ? "N" : trial.unit;
  if (model != nullptr) {
    trace.class_names = model->model().class_names;
    trace.probability.resize(trace.class_names.size());
  }
  if (trial.taxels.empty()) {
    TACTUS_RETURN_IF_ERROR(TraceSignals(trial, model, trace));
    return trace;
  }
  TACTUS_ASSIGN_OR_RETURN(trace.layout, LayoutOfTrial(trial, &given));
  TACTUS_RETURN_IF_ERROR(TraceTaxels(trial, model, trace));
  return trace;
}

}  // namespace tactus::internal::client
