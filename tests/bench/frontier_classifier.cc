#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/eval/evaluate.h"
#include "core/eval/metrics.h"
#include "tests/bench/frontier.h"
#include "tests/bench/timing.h"
#include "tools/common/percentile.h"

namespace tactus::internal::client {
namespace {

constexpr int kTimedContacts = 48;
constexpr int kRounds = 15;
// Least accuracy. Guesses among four classes do not reach kGuesses; the preset
// fitted in full reaches kTuned.
constexpr double kGuesses = 0.35;
constexpr double kTuned = 0.9;

int FrontierTime() {
  return static_cast<int>(std::ranges::find(kAnytimeSeconds, kFrontierSeconds) -
                          std::begin(kAnytimeSeconds));
}

int FrontierFrames(const LabelledContact& contact) {
  return std::min<int>(
      static_cast<int>(kFrontierSeconds * contact.sample_rate_hz),
      std::ssize(contact.frames));
}

absl::StatusOr<Evaluation> Evaluate(
    const std::shared_ptr<const CompiledModel>& model,
    const std::vector<LabelledContact>& contacts) {
  return EvaluateModel(model, Pointers(contacts), Algorithm::kFused,
                       RunOnThreads);
}

// Steps each model through the first frames of some contacts; ns a frame,
// medians of rounds in which the models take turns.
std::vector<double> TimeVariants(const std::vector<ClassifierVariant>& variants,
                                 const std::vector<LabelledContact>& contacts,
                                 int rounds) {
  const int sample = std::min<int>(kTimedContacts, std::ssize(contacts));
  std::vector<ContactClassifier> classifiers;
  for (const ClassifierVariant& variant : variants) {
    classifiers.emplace_back(variant.model, ContactClassifier::Options(),
                             variant.skip);
  }
  int64_t frames = 0;
  const auto run = [&](ContactClassifier& classifier) {
    frames = 0;
    for (int c = 0; c < sample; ++c) {
      const LabelledContact& contact = contacts[c];
      const int count = FrontierFrames(contact);
      classifier.Reset();
      for (int t = 0; t < count; ++t) {
        classifier.StepOrHold(contact.frames[t], 0);
      }
      frames += count;
    }
  };
  std::vector<std::vector<double>> seconds(variants.size());
  for (int round = 0; round <= rounds; ++round) {
    for (size_t v = 0; v < variants.size(); ++v) {
      const double start = ThreadSeconds();
      run(classifiers[v]);
      const double once = ThreadSeconds() - start;
      // The first round warms caches.
      if (round > 0) seconds[v].push_back(once);
    }
  }
  std::vector<double> nanoseconds;
  for (std::vector<double>& each : seconds) {
    nanoseconds.push_back(Percentile(each, 0.5) / static_cast<double>(frames) *
                          1e9);
  }
  return nanoseconds;
}

int BestOf(std::span<const double> probability) {
  return static_cast<int>(std::ranges::max_element(probability) -
                          probability.begin());
}

// A part alone must answer as it does within the whole. Looks are off: when
// they are taken depends on the answer of the whole.
absl::Status CheckPart(const ClassifierVariant& part,
                       const ClassifierVariant& whole,
                       std::span<const double> (ContactClassifier::*answer)()
                           const,
                       const std::vector<LabelledContact>& contacts) {
  ContactClassifier alone(part.model, {.looks = false}, part.skip);
  ContactClassifier within(whole.model, {.looks = false}, whole.skip);
  for (const LabelledContact& contact : contacts) {
    alone.Reset();
    within.Reset();
    for (int t = 0; t < FrontierFrames(contact); ++t) {
      alone.StepOrHold(contact.frames[t], 0);
      within.StepOrHold(contact.frames[t], 0);
    }
    if (BestOf((alone.*answer)()) == BestOf((within.*answer)())) continue;
    return NumericalFailure(absl::StrFormat(
        "%s alone answer test contact %s differently than within the whole "
        "model",
        part.name, contact.id));
  }
  return absl::OkStatus();
}

// Accuracies are measured with the skip rules on. No bit may depend on them.
absl::Status CheckUnskipped(const ClassifierVariant& skipped,
                            const ClassifierVariant& unskipped,
                            const std::vector<LabelledContact>& contacts) {
  ContactClassifier a(skipped.model, {}, skipped.skip);
  ContactClassifier b(unskipped.model, {}, unskipped.skip);
  for (const LabelledContact& contact : contacts) {
    a.Reset();
    b.Reset();
    for (const ContactFrame& frame : contact.frames) {
      a.StepOrHold(frame, 0);
      b.StepOrHold(frame, 0);
      if (std::ranges::equal(a.probability(), b.probability())) continue;
      return NumericalFailure(absl::StrFormat(
          "skip rules change the probabilities of test contact %s",
          contact.id));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<double> AccuracyOf(
    const std::shared_ptr<const CompiledModel>& model,
    const std::vector<LabelledContact>& contacts) {
  TACTUS_ASSIGN_OR_RETURN(const Evaluation evaluation,
                          Evaluate(model, contacts));
  return Accuracy(evaluation.anytime[FrontierTime()]);
}

absl::StatusOr<MeasuredClassifiers> MeasureClassifiers(
    const FrontierContacts& contacts, bool quick) {
  TACTUS_ASSIGN_OR_RETURN(const std::vector<ClassifierVariant> variants,
                          FitVariants(contacts.training, quick));
  MeasuredClassifiers measured;
  measured.tuned = variants[kTunedVariant].model;
  const std::vector<double> nanoseconds =
      TimeVariants(variants, contacts.test, quick ? 2 : kRounds);
  std::vector<Evaluation> evaluations;
  for (size_t v = 0; v < variants.size(); ++v) {
    TACTUS_ASSIGN_OR_RETURN(evaluations.emplace_back(),
                            Evaluate(variants[v].model, contacts.test));
    const Evaluation& evaluation = evaluations.back();
    measured.points.push_back(
        {.comparison = Comparison::kClassifier,
         .family = variants[v].family,
         .variant = variants[v].name,
         .nanoseconds = nanoseconds[v],
         .contacts = contacts.test.size(),
         .accuracy = Accuracy(evaluation.anytime[FrontierTime()]),
         .final_accuracy = Accuracy(evaluation.final)});
  }
  TACTUS_RETURN_IF_ERROR(CheckUnskipped(
      variants[kTunedVariant], variants[kUnskippedVariant], contacts.test));
  TACTUS_RETURN_IF_ERROR(
      CheckPart(variants[kHmmVariant], variants[kTunedVariant],
                &ContactClassifier::hmm_probability, contacts.test));
  TACTUS_RETURN_IF_ERROR(
      CheckPart(variants[kLstmVariant], variants[kTunedVariant],
                &ContactClassifier::lstm_probability, contacts.test));
  const double right = measured.points[kTunedVariant].accuracy;
  if (right < (quick ? kGuesses : kTuned)) {
    return NumericalFailure(absl::StrFormat(
        "only %.1f %% of the test contacts are classified correctly",
        100 * right));
  }
  return measured;
}

}  // namespace tactus::internal::client
