#include "core/train/calibrate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/classify/calibration.h"
#include "core/classify/contact_classifier.h"
#include "core/train/anytime.h"

namespace tactus {
namespace {

// Keep a division finite, and a scale within reason.
constexpr double kLeastDeviation = 1e-12;
constexpr double kLeastScale = 0.01;

using Scores = std::vector<std::vector<double>>;

constexpr double kMinTemperature = 1e-4;
// HMMs are never sharpened: the frames of a contact say less than they claim.
constexpr double kMaxHmmTemperature = 1;
constexpr double kMaxLstmTemperature = 4;
// Weights tried are multiples of one over this.
constexpr int kWeightSteps = 20;
// Keeps a constant score from making everything else unknown.
constexpr double kMinEvidenceDeviation = 0.1;
// Share of known contacts that may be called unknown.
constexpr double kFalseAlarms = 0.05;

// The probabilities that one held-out contact is given.
struct LabelledPosterior {
  int label = 0;
  std::vector<double> probability;
};

// Mean of -log(probability of the label). The floor keeps one contact whose
// label has probability 0 from deciding everything.
double LogLoss(std::span<const LabelledPosterior> posteriors) {
  constexpr double kLeastProbability = 1e-12;
  double sum = 0;
  for (const LabelledPosterior& posterior : posteriors) {
    sum -= std::log(
        std::max(posterior.probability[posterior.label], kLeastProbability));
  }
  return sum / static_cast<double>(posteriors.size());
}

// Probabilities of the classes of every contact under a temperature.
std::vector<LabelledPosterior> Temper(std::span<const ScoredContact> contacts,
                                      Scores ScoredContact::*scores,
                                      size_t time,
                                      std::span<const double> log_prior,
                                      double temperature) {
  std::vector<LabelledPosterior> posteriors;
  posteriors.reserve(contacts.size());
  for (const ScoredContact& contact : contacts) {
    LabelledPosterior posterior{contact.label,
                                std::vector<double>(log_prior.size())};
    TemperedPosterior(log_prior, (contact.*scores)[time], temperature,
                      posterior.probability);
    posteriors.push_back(std::move(posterior));
  }
  return posteriors;
}

// Golden-section search for the logarithm of the temperature at which the
// labels are most likely.
double BestTemperature(std::span<const ScoredContact> contacts,
                       Scores ScoredContact::*scores, size_t time,
                       std::span<const double> log_prior, double most) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr int kSteps = 40;
  auto loss = [&](double x) {
    return LogLoss(Temper(contacts, scores, time, log_prior, std::exp(x)));
  };
  double low = std::log(kMinTemperature);
  double high = std::log(most);
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

// The LSTM's share at which the fused labels are most likely.
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

// What the best class's log-likelihood per step is like. The deviation is such
// that kFalseAlarms of the contacts are rather unknown: the tail towards the
// unlikely is heavy, and a variance says little of it.
void FitEvidence(std::span<const ScoredContact> contacts, size_t time,
                 Calibration& calibration) {
  std::vector<double> evidence;
  for (const ScoredContact& contact : contacts) {
    const auto& scores = contact.log_likelihood[time];
    evidence.push_back(*std::max_element(scores.begin(), scores.end()) /
                       std::max(contact.hmm_steps[time], 1.0));
  }
  std::sort(evidence.begin(), evidence.end());
  const auto quantile = [&](double share) {
    return evidence[static_cast<size_t>(
        share * static_cast<double>(evidence.size() - 1))];
  };
  const double median = quantile(0.5);
  calibration.evidence_mean.push_back(median);
  calibration.evidence_deviation.push_back(
      std::max((median - quantile(kFalseAlarms)) / kUnknownDeviations,
               kMinEvidenceDeviation));
}

// Scales deviations so that they cover two thirds of the errors: robust
// against the few that are far off.
void FitEstimateScales(std::span<const ScoredContact> contacts,
                       Calibration& calibration) {
  constexpr double kCovered = 0.683;
  std::vector<double> stiffness;
  std::vector<double> moved;
  for (const ScoredContact& contact : contacts) {
    for (const ScoredContact::Estimate& estimate : contact.estimates) {
      const ObjectEstimate& said = estimate.said;
      stiffness.push_back(
          std::abs(said.log10_stiffness - estimate.log10_stiffness) /
          std::max(said.log10_stiffness_deviation, kLeastDeviation));
      moved.push_back(std::abs(said.moved_m - estimate.moved_m) /
                      std::max(said.moved_deviation_m, kLeastDeviation));
    }
  }
  auto scale = [&](std::vector<double>& errors) {
    if (errors.empty()) return 1.0;
    const auto place =
        errors.begin() + static_cast<ptrdiff_t>(kCovered * (errors.size() - 1));
    std::nth_element(errors.begin(), place, errors.end());
    return std::clamp(*place, kLeastScale, 1 / kLeastScale);
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

void FitCalibration(std::span<const ScoredContact> contacts, double rate,
                    Calibration& calibration) {
  Calibration& c = calibration;
  c.frames = CalibrationFrames(rate);
  for (auto* table : {&c.hmm_temperature, &c.lstm_temperature, &c.lstm_weight,
                      &c.evidence_mean, &c.evidence_deviation}) {
    table->clear();
  }
  std::vector<double> log_prior;
  for (double p : c.prior) log_prior.push_back(std::log(p));
  for (size_t time = 0; time < c.frames.size(); ++time) {
    c.hmm_temperature.push_back(
        BestTemperature(contacts, &ScoredContact::log_likelihood, time,
                        log_prior, kMaxHmmTemperature));
    FitEvidence(contacts, time, c);
    if (contacts.front().lstm_score.empty()) continue;
    c.lstm_temperature.push_back(
        BestTemperature(contacts, &ScoredContact::lstm_score, time, log_prior,
                        kMaxLstmTemperature));
    c.lstm_weight.push_back(
        BestWeight(Temper(contacts, &ScoredContact::log_likelihood, time,
                          log_prior, c.hmm_temperature.back()),
                   Temper(contacts, &ScoredContact::lstm_score, time, log_prior,
                          c.lstm_temperature.back())));
  }
  FitEstimateScales(contacts, c);
}

}  // namespace tactus
