#include "core/train/calibrate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/classify/calibration.h"
#include "core/classify/contact_classifier.h"
#include "core/train/anytime.h"

namespace tactus {
namespace {

// Keeps divisions finite.
constexpr double kMinDeviation = 1e-12;
// Scales of deviations are at least this, and at most its inverse.
constexpr double kMinScale = 0.01;

using Scores = std::vector<std::vector<double>>;

constexpr double kMinInverseTemperature = 1e-4;
// HMMs are never made more confident, because frames are not independent.
constexpr double kMaxHmmInverseTemperature = 1;
constexpr double kMaxLstmInverseTemperature = 4;
// The weights tried are multiples of 1 / kWeightSteps.
constexpr int kWeightSteps = 20;
// Otherwise a constant score would make every other contact unknown.
constexpr double kMinEvidenceDeviation = 0.1;
// Fraction of known contacts that may be called unknown.
constexpr double kFalseAlarms = 0.05;

// The probabilities that one held-out contact is given.
struct LabelledPosterior {
  int label = 0;
  std::vector<double> probability;
};

// Mean of -log(probability of the label). The floor keeps one contact whose
// label has probability 0 from deciding everything.
double LogLoss(std::span<const LabelledPosterior> posteriors) {
  constexpr double kMinProbability = 1e-12;
  double sum = 0;
  for (const LabelledPosterior& posterior : posteriors) {
    sum -= std::log(
        std::max(posterior.probability[posterior.label], kMinProbability));
  }
  return sum / static_cast<double>(posteriors.size());
}

// Returns the class probabilities of every contact.
std::vector<LabelledPosterior> Temper(std::span<const ScoredContact> contacts,
                                      Scores ScoredContact::*scores,
                                      size_t time,
                                      std::span<const double> log_prior,
                                      double inverse_temperature) {
  std::vector<LabelledPosterior> posteriors;
  posteriors.reserve(contacts.size());
  for (const ScoredContact& contact : contacts) {
    LabelledPosterior posterior{contact.label,
                                std::vector<double>(log_prior.size())};
    TemperedPosterior(log_prior, (contact.*scores)[time], inverse_temperature,
                      posterior.probability);
    posteriors.push_back(std::move(posterior));
  }
  return posteriors;
}

// Finds the inverse temperature at which the labels are most likely, by
// golden-section search over its logarithm.
double BestInverseTemperature(std::span<const ScoredContact> contacts,
                              Scores ScoredContact::*scores, size_t time,
                              std::span<const double> log_prior,
                              double max_inverse_temperature) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr int kSteps = 40;
  auto loss = [&](double x) {
    return LogLoss(Temper(contacts, scores, time, log_prior, std::exp(x)));
  };
  double low = std::log(kMinInverseTemperature);
  double high = std::log(max_inverse_temperature);
  double a = high - kGolden * (high - low);
  double b = low + kGolden * (high - low);
  double loss_a = loss(a);
  double loss_b = loss(b);
  for (int step = 0; step < kSteps; ++step) {
    if (loss_a <= loss_b) {
      high = b;
      b = a;
      loss_b = loss_a;
      a = high - kGolden * (high - low);
      loss_a = loss(a);
    } else {
      low = a;
      a = b;
      loss_a = loss_b;
      b = low + kGolden * (high - low);
      loss_b = loss(b);
    }
  }
  return std::exp(0.5 * (low + high));
}

// Finds the weight of the LSTMs at which the labels are most likely.
double BestWeight(std::span<const LabelledPosterior> hmm,
                  std::span<const LabelledPosterior> lstm) {
  double best_weight = 0;
  double best_loss = std::numeric_limits<double>::infinity();
  std::vector<LabelledPosterior> fused(hmm.begin(), hmm.end());
  for (int step = 0; step <= kWeightSteps; ++step) {
    const double weight = static_cast<double>(step) / kWeightSteps;
    for (size_t i = 0; i < fused.size(); ++i) {
      FusePosteriors(hmm[i].probability, lstm[i].probability, weight,
                     fused[i].probability);
    }
    const double loss = LogLoss(fused);
    if (loss < best_loss) {
      best_loss = loss;
      best_weight = weight;
    }
  }
  return best_weight;
}

// Fits median and deviation of the best class's log-likelihood per step. The
// deviation makes `unknown` larger than one half for kFalseAlarms of the
// contacts. It is not the standard deviation, because the lower tail is heavy.
void FitEvidence(std::span<const ScoredContact> contacts, size_t time,
                 Calibration& calibration) {
  std::vector<double> evidence;
  for (const ScoredContact& contact : contacts) {
    const auto& scores = contact.log_likelihood[time];
    evidence.push_back(*std::max_element(scores.begin(), scores.end()) /
                       std::max(contact.hmm_steps[time], 1.0));
  }
  std::sort(evidence.begin(), evidence.end());
  const auto quantile = [&](double fraction) {
    return evidence[static_cast<size_t>(
        fraction * static_cast<double>(evidence.size() - 1))];
  };
  const double median = quantile(0.5);
  calibration.evidence_median.push_back(median);
  calibration.evidence_deviation.push_back(
      std::max((median - quantile(kFalseAlarms)) / kUnknownDeviations,
               kMinEvidenceDeviation));
}

// Scales the estimated deviations so that 68.3 % of the errors lie within one
// of them. A few large errors do not change the scales much.
void FitEstimateScales(std::span<const ScoredContact> contacts,
                       Calibration& calibration) {
  constexpr double kCovered = 0.683;
  std::vector<double> stiffness;
  std::vector<double> moved;
  for (const ScoredContact& contact : contacts) {
    for (const ScoredContact::Estimate& truth : contact.estimates) {
      const ObjectEstimate& found = truth.estimate;
      stiffness.push_back(
          std::abs(found.log10_stiffness - truth.log10_stiffness) /
          std::max(found.log10_stiffness_deviation, kMinDeviation));
      moved.push_back(std::abs(found.moved_m - truth.moved_m) /
                      std::max(found.moved_deviation_m, kMinDeviation));
    }
  }
  auto scale = [&](std::vector<double>& errors) {
    if (errors.empty()) return 1.0;
    const auto place =
        errors.begin() + static_cast<ptrdiff_t>(kCovered * (errors.size() - 1));
    std::nth_element(errors.begin(), place, errors.end());
    return std::clamp(*place, kMinScale, 1 / kMinScale);
  };
  calibration.stiffness_deviation_scale = scale(stiffness);
  calibration.moved_deviation_scale = scale(moved);
}

}  // namespace

std::vector<double> CalibrationFrames(double rate) {
  const auto frames = AnytimeFrames(rate);
  std::vector<double> distinct(frames.begin(), frames.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  return distinct;
}

ScoredContact ScoreContact(const std::shared_ptr<const CompiledModel>& model,
                           const LabelledContact& contact, int label) {
  ScoredContact scored;
  scored.label = label;
  ContactClassifier classifier(model, {});
  auto record = [&] {
    const auto scores = classifier.log_likelihood();
    scored.log_likelihood.emplace_back(scores.begin(), scores.end());
    const auto lstm = classifier.lstm_score();
    if (!lstm.empty()) scored.lstm_score.emplace_back(lstm.begin(), lstm.end());
    if (classifier.object() && !contact.object_motion.empty()) {
      scored.estimates.push_back(
          {*classifier.object(), std::log10(contact.stiffness),
           contact.object_motion[classifier.frames() - 1]});
    }
    scored.hmm_steps.push_back(static_cast<double>(classifier.hmm_steps()));
  };
  const auto frames = AnytimeFrames(contact.sample_rate_hz);
  WalkContact(contact, classifier, [&](int time) {
    if (time == 0 || frames[time] > frames[time - 1]) record();
  });
  return scored;
}

HeldOutSkill SkillOf(std::span<const ScoredContact> contacts) {
  std::vector<LabelledPosterior> posteriors;
  double right = 0;
  for (const ScoredContact& contact : contacts) {
    const std::vector<double>& scores = contact.log_likelihood.back();
    const std::vector<double> log_prior(scores.size(), 0.0);
    std::vector<double> probability(scores.size());
    TemperedPosterior(log_prior, scores, 1, probability);
    if (!contact.lstm_score.empty()) {
      std::vector<double> lstm(scores.size());
      TemperedPosterior(log_prior, contact.lstm_score.back(), 1, lstm);
      FusePosteriors(std::vector<double>(probability), lstm, 0.5, probability);
    }
    right += std::ranges::max_element(probability) - probability.begin() ==
             contact.label;
    posteriors.push_back({contact.label, std::move(probability)});
  }
  return {LogLoss(posteriors), right / static_cast<double>(contacts.size())};
}

void FitCalibration(std::span<const ScoredContact> contacts, double rate,
                    Calibration& calibration) {
  Calibration& c = calibration;
  c.frames = CalibrationFrames(rate);
  for (auto* table :
       {&c.hmm_inverse_temperature, &c.lstm_inverse_temperature, &c.lstm_weight,
        &c.evidence_median, &c.evidence_deviation}) {
    table->clear();
  }
  std::vector<double> log_prior;
  for (double p : c.prior) log_prior.push_back(std::log(p));
  for (size_t time = 0; time < c.frames.size(); ++time) {
    c.hmm_inverse_temperature.push_back(
        BestInverseTemperature(contacts, &ScoredContact::log_likelihood, time,
                               log_prior, kMaxHmmInverseTemperature));
    FitEvidence(contacts, time, c);
    if (contacts.front().lstm_score.empty()) continue;
    c.lstm_inverse_temperature.push_back(
        BestInverseTemperature(contacts, &ScoredContact::lstm_score, time,
                               log_prior, kMaxLstmInverseTemperature));
    c.lstm_weight.push_back(
        BestWeight(Temper(contacts, &ScoredContact::log_likelihood, time,
                          log_prior, c.hmm_inverse_temperature.back()),
                   Temper(contacts, &ScoredContact::lstm_score, time, log_prior,
                          c.lstm_inverse_temperature.back())));
  }
  FitEstimateScales(contacts, c);
}

}  // namespace tactus
