#include "server/trainer/compare.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/limits.h"
#include "core/contacts/anytime.h"
#include "core/eval/metrics.h"
#include "core/eval/reliability.h"

namespace tactus::internal::server {
namespace {

// Smallest probability that a logarithm is taken of.
constexpr double kMinProbability = 1e-300;

v1::Accuracy AccuracyOf(int right, int count) {
  v1::Accuracy accuracy;
  const Interval interval = WilsonInterval(right, count);
  accuracy.set_correct(static_cast<uint32_t>(right));
  accuracy.set_contacts(static_cast<uint32_t>(count));
  accuracy.set_low(interval.low);
  accuracy.set_high(interval.high);
  return accuracy;
}

v1::Accuracy AccuracyOf(std::span<const Outcome> outcomes) {
  return AccuracyOf(CountRight(outcomes), static_cast<int>(outcomes.size()));
}

void AddQuestions(const Evaluation& evaluation, v1::EvaluationReport& report) {
  for (size_t q = 0; q < evaluation.questions.size(); ++q) {
    const auto& outcomes = evaluation.question_outcomes[q];
    const auto accuracy_of = [&](auto outcome_at) {
      const auto right = std::ranges::count_if(outcomes, [&](const auto& all) {
        const Outcome& outcome = outcome_at(all);
        return outcome.answer() == outcome.label;
      });
      return AccuracyOf(static_cast<int>(right),
                        static_cast<int>(outcomes.size()));
    };
    v1::QuestionReport& question = *report.add_questions();
    question.set_name(evaluation.questions[q].name);
    *question.mutable_accuracy() = accuracy_of(
        [](const QuestionOutcome& all) -> const Outcome& { return all.final; });
    for (int t = 0; t < kAnytimeCount; ++t) {
      *question.add_anytime() =
          accuracy_of([t](const QuestionOutcome& all) -> const Outcome& {
            return all.anytime[t];
          });
    }
  }
}

void AddReliability(std::span<const Outcome> outcomes,
                    v1::EvaluationReport& report) {
  for (const ReliabilityBin& bin : ReliabilityBins(outcomes)) {
    v1::ReliabilityBin& added = *report.add_reliability();
    added.set_low(bin.low);
    added.set_high(bin.high);
    added.set_confidence(bin.mean_probability);
    *added.mutable_accuracy() = AccuracyOf(bin.right, bin.count);
  }
}

double LogLoss(std::span<const Outcome> outcomes) {
  if (outcomes.empty()) return 0;
  double sum = 0;
  for (const Outcome& outcome : outcomes) {
    sum -=
        std::log(std::max(outcome.probability[outcome.label], kMinProbability));
  }
  return sum / static_cast<double>(outcomes.size());
}

// Probability of at most `successes` of `count` with probability `p` each.
double BinomialTail(uint32_t successes, uint32_t count, double p) {
  double sum = 0;
  for (uint32_t k = 0; k <= successes; ++k) {
    sum += std::exp(std::lgamma(count + 1.0) - std::lgamma(k + 1.0) -
                    std::lgamma(count - k + 1.0) + k * std::log(p) +
                    (count - k) * std::log1p(-p));
  }
  return std::min(sum, 1.0);
}

// The p at which `tail(p)`, which falls, is `level`.
template <typename Tail>
double Solve(const Tail& tail, double level) {
  double low = 0;
  double high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (tail(middle) > level ? low : high) = middle;
  }
  return (low + high) / 2;
}

// Clopper and Pearson's exact 95 % interval of a fraction.
std::pair<double, double> ExactInterval(uint32_t successes, uint32_t count) {
  constexpr double kHalf = 0.025;
  const double high =
      successes == count
          ? 1
          : Solve([&](double p) { return BinomialTail(successes, count, p); },
                  kHalf);
  const double low =
      successes == 0
          ? 0
          : Solve(
                [&](double p) { return BinomialTail(successes - 1, count, p); },
                1 - kHalf);
  return {low, high};
}

// Says what is wrong if `candidate` exceeds `current` by more than `margin`.
void Limit(absl::string_view what, double current, double candidate,
           double margin, std::string& failure) {
  if (candidate <= current + margin) return;
  absl::StrAppend(&failure, failure.empty() ? "" : "; ", what, " is ",
                  candidate, "; it must be at most ", current + margin);
}

}  // namespace

double McNemar(uint32_t first, uint32_t second) {
  const uint32_t count = first + second;
  if (count == 0) return 1;
  return std::min(1.0, 2 * BinomialTail(std::min(first, second), count, 0.5));
}

v1::EvaluationReport ReportOf(const Evaluation& evaluation,
                              uint32_t never_felt) {
  v1::EvaluationReport report;
  *report.mutable_accuracy() = AccuracyOf(evaluation.final);
  report.set_never_felt(never_felt);
  report.set_log_loss(LogLoss(evaluation.final));
  report.set_calibration_error(ExpectedCalibrationError(evaluation.final));
  for (const std::string& name : evaluation.class_names) {
    report.add_class_names(name);
  }
  const Confusion confusion = CountConfusion(
      evaluation.final, static_cast<int>(evaluation.class_names.size()));
  for (const auto& row : confusion) {
    for (const int count : row) {
      report.add_confusion(static_cast<uint32_t>(count));
    }
  }
  for (int t = 0; t < kAnytimeCount; ++t) {
    report.add_anytime_s(kAnytimeSeconds[t]);
    *report.add_anytime() = AccuracyOf(evaluation.anytime[t]);
  }
  AddQuestions(evaluation, report);
  AddReliability(evaluation.final, report);
  return report;
}

void AddWrongAnswers(const Evaluation& evaluation,
                     const std::vector<const LabelledContact*>& contacts,
                     v1::EvaluationReport& report) {
  for (size_t i = 0; i < contacts.size(); ++i) {
    const Outcome& outcome = evaluation.final[i];
    if (outcome.answer() == outcome.label) continue;
    if (report.wrong_size() == limits::kMaxNamedTrials) return;
    v1::WrongAnswer& wrong = *report.add_wrong();
    wrong.set_name(ContactName(*contacts[i]));
    wrong.set_label(evaluation.class_names[outcome.label]);
    wrong.set_answer(evaluation.class_names[outcome.answer()]);
  }
}

void AddTrainedOn(const TrainedOn& trained, v1::EvaluationReport& report) {
  if (trained.basis == TrainingBasis::kUnknown) return;
  report.set_trained_on_data(trained.contacts > 0);
  report.set_trained_on_contacts(static_cast<uint32_t>(trained.contacts));
  report.set_training_basis(
      static_cast<v1::TrainingBasis>(static_cast<int>(trained.basis)));
}

v1::Comparison Compare(const Evaluation& current, const Evaluation& candidate,
                       uint32_t never_felt, const v1::JobGate& gate) {
  v1::Comparison comparison;
  *comparison.mutable_current() = ReportOf(current, never_felt);
  *comparison.mutable_candidate() = ReportOf(candidate, never_felt);
  uint32_t only_current = 0;
  uint32_t only_candidate = 0;
  for (size_t i = 0; i < current.final.size(); ++i) {
    // The two models may number their classes differently.
    const bool old_right = current.final[i].answer() == current.final[i].label;
    const bool new_right =
        candidate.final[i].answer() == candidate.final[i].label;
    only_current += old_right && !new_right ? 1 : 0;
    only_candidate += new_right && !old_right ? 1 : 0;
  }
  comparison.set_only_current(only_current);
  comparison.set_only_candidate(only_candidate);
  comparison.set_mcnemar_p(McNemar(only_current, only_candidate));
  const auto [low, high] =
      ExactInterval(only_candidate, only_current + only_candidate);
  comparison.set_win_low(low);
  comparison.set_win_high(high);
  std::string failure;
  Limit("error rate", 1 - Accuracy(current.final),
        1 - Accuracy(candidate.final), gate.accuracy_margin(), failure);
  Limit("log-loss", comparison.current().log_loss(),
        comparison.candidate().log_loss(), gate.log_loss_margin(), failure);
  Limit("calibration error", comparison.current().calibration_error(),
        comparison.candidate().calibration_error(), gate.calibration_margin(),
        failure);
  comparison.set_passed(failure.empty());
  comparison.set_failure(failure);
  return comparison;
}

}  // namespace tactus::internal::server
