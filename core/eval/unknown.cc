#include "core/eval/unknown.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/classify/contact_classifier.h"
#include "core/contacts/folds.h"

namespace tactus::internal {
namespace {

constexpr size_t kMinClasses = 3;
constexpr double kUnknown = 0.5;
// 97.5 % of a normal distribution lie below.
constexpr double kNormal95 = 1.959963984540054;

// Returns `unknown` of every contact of `fold`, by a model that is fitted to
// the contacts outside of `fold` and of the class `left_out`.
absl::StatusOr<std::vector<double>> ScoreFold(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<int>& fold, const std::string& left_out,
    const FitOptions& options, const Progress& progress) {
  std::vector<const LabelledContact*> rest;
  for (int i : Complement(fold, static_cast<int>(contacts.size()))) {
    if (contacts[i]->label != left_out) rest.push_back(contacts[i]);
  }
  TACTUS_ASSIGN_OR_RETURN(Model model,
                          FitModel(rest, options, RunSerially, progress));
  TACTUS_ASSIGN_OR_RETURN(const auto compiled,
                          CompiledModel::Create(std::move(model)));
  std::vector<double> unknown;
  for (int i : fold) {
    ContactClassifier classifier(compiled, {});
    for (const ContactFrame& frame : contacts[i]->frames) {
      classifier.StepOrHold(frame, /*missing_before=*/0);
    }
    unknown.push_back(classifier.unknown());
  }
  return unknown;
}

double FractionAbove(std::span<const double> values, double limit) {
  if (values.empty()) return 0;
  const auto above = std::count_if(values.begin(), values.end(),
                                   [&](double v) { return v > limit; });
  return static_cast<double>(above) / static_cast<double>(values.size());
}

}  // namespace

double AreaUnderRoc(std::span<const double> positive,
                    std::span<const double> negative) {
  if (positive.empty() || negative.empty()) return 0.5;
  std::vector<double> sorted(negative.begin(), negative.end());
  std::sort(sorted.begin(), sorted.end());
  double sum = 0;
  for (double value : positive) {
    const auto [first, last] =
        std::equal_range(sorted.begin(), sorted.end(), value);
    sum += static_cast<double>(first - sorted.begin()) +
           0.5 * static_cast<double>(last - first);
  }
  return sum / static_cast<double>(positive.size()) /
         static_cast<double>(negative.size());
}

Interval AreaInterval(double area, int positive, int negative) {
  if (positive == 0 || negative == 0) return {0, 1};
  const double two_positives = area / (2 - area);
  const double two_negatives = 2 * area * area / (1 + area);
  const double square = area * area;
  const double variance =
      (area * (1 - area) + (positive - 1) * (two_positives - square) +
       (negative - 1) * (two_negatives - square)) /
      (static_cast<double>(positive) * negative);
  const double half = kNormal95 * std::sqrt(variance);
  return {std::max(area - half, 0.0), std::min(area + half, 1.0)};
}

absl::StatusOr<std::vector<UnknownResult>> EvaluateUnknown(
    const std::vector<const LabelledContact*>& contacts,
    const FitOptions& options, const ParallelFor& parallel,
    const Progress& progress) {
  const std::vector<std::string> classes = ClassNames(contacts);
  if (classes.size() < kMinClasses) {
    return InvalidTrainingData(
        absl::StrCat("the contacts have ", classes.size(),
                     " classes; leaving one out takes ", kMinClasses));
  }
  TACTUS_ASSIGN_OR_RETURN(const auto folds,
                          MakeFolds(contacts, Protocol::kLeaveOneConditionOut));
  FitOptions needed = options;
  // The networks that classify do not change `unknown`. An estimator is only
  // trained beside one, so one is trained and is as small as can be.
  const bool estimates = options.lstm.estimates && options.lstm.networks > 0;
  needed.lstm.networks = estimates ? 1 : 0;
  needed.lstm.cells = {1};

  const size_t jobs = classes.size() * folds.size();
  std::vector<absl::StatusOr<std::vector<double>>> unknown(
      jobs, std::vector<double>());
  const Progress job_progress = progress.Part("fit and test folds", 1)
                                    .Part("", 1 / static_cast<double>(jobs));
  parallel(static_cast<int>(jobs), [&](int job) {
    unknown[job] = ScoreFold(contacts, folds[job % folds.size()],
                             classes[job / folds.size()], needed, job_progress);
  });

  std::vector<UnknownResult> results;
  for (size_t c = 0; c < classes.size(); ++c) {
    std::vector<double> left_out;
    std::vector<double> known;
    for (size_t f = 0; f < folds.size(); ++f) {
      const auto& scores = unknown[c * folds.size() + f];
      TACTUS_RETURN_IF_ERROR(scores.status());
      for (size_t i = 0; i < folds[f].size(); ++i) {
        const bool is_known = contacts[folds[f][i]]->label != classes[c];
        (is_known ? known : left_out).push_back((*scores)[i]);
      }
    }
    const double area = AreaUnderRoc(left_out, known);
    results.push_back(
        {.left_out = classes[c],
         .contacts = static_cast<int>(left_out.size()),
         .other_contacts = static_cast<int>(known.size()),
         .detected = FractionAbove(left_out, kUnknown),
         .false_alarms = FractionAbove(known, kUnknown),
         .area_under_roc = area,
         .area_interval = AreaInterval(area, static_cast<int>(left_out.size()),
                                       static_cast<int>(known.size()))});
  }
  return results;
}

}  // namespace tactus::internal
