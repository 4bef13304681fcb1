#include "core/train/fit_decisions.h"

#include "core/base/wilson_interval.h"
#include "core/classify/contact_classifier.h"
#include "core/contacts/anytime.h"
#include "core/contacts/question_truth.h"
#include "core/questions/decision_tracker.h"

namespace tactus::internal {
namespace {

constexpr size_t kThresholds = kTriedThresholds.size();

bool CanPass(int decisions) {
  return WilsonInterval(decisions, decisions).low >= kDecisionsThatHold;
}

double FitThreshold(std::span<const TriedDecisions> tried, size_t question) {
  double fitted = kTriedThresholds.back();
  for (size_t t = kThresholds; t-- > 0;) {
    int made = 0;
    int held = 0;
    for (const TriedDecisions& contact : tried) {
      const std::optional<bool>& decision = contact[question][t];
      made += decision.has_value();
      held += decision.value_or(false);
    }
    if (!CanPass(made)) continue;
    if (WilsonInterval(held, made).low < kDecisionsThatHold) break;
    fitted = kTriedThresholds[t];
  }
  return fitted;
}

}  // namespace

TriedDecisions TryDecisions(const std::shared_ptr<const CompiledModel>& model,
                            const LabelledContact& contact) {
  const std::vector<Question>& questions = model->questions();
  std::vector<DecisionTracker> trackers;
  for (const double threshold : kTriedThresholds) {
    std::vector<DecisionRule> rules = model->rules();
    for (DecisionRule& rule : rules) rule.threshold = threshold;
    trackers.emplace_back(std::move(rules));
  }
  std::vector<QuestionTruth> truths;
  for (const Question& question : questions) {
    truths.emplace_back(question, model->model().class_names, contact);
  }
  TriedDecisions tried(questions.size());
  ContactClassifier classifier(model, {});
  WalkFrames(contact, classifier, [&](size_t frame) {
    // Frames without touch decide nothing.
    if (!contact.frames.touched(frame)) return;
    for (size_t q = 0; q < questions.size(); ++q) {
      for (size_t t = 0; t < kThresholds; ++t) {
        if (trackers[t].Step(q, classifier.value_probability(q),
                             classifier.unknown(),
                             classifier.frames()) != DecisionEvent::kDecided) {
          continue;
        }
        tried[q][t] = trackers[t].decisions()[q].value == truths[q].at(frame);
      }
    }
  });
  return tried;
}

void FitDecisions(std::span<const TriedDecisions> tried,
                  Calibration& calibration) {
  const size_t questions = tried.front().size();
  calibration.question_threshold.clear();
  for (size_t q = 0; q < questions; ++q) {
    calibration.question_threshold.push_back(FitThreshold(tried, q));
  }
  calibration.question_frames.assign(questions, calibration.decision_frames);
}

}  // namespace tactus::internal
