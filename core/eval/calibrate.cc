#include "core/eval/calibrate.h"

#include <algorithm>
#include <cmath>

#include "core/classify/calibration.h"
#include "core/classify/contact_classifier.h"
#include "core/eval/metrics.h"

namespace tactus {
namespace {

// Never sharper than the model itself.
constexpr double kMaxTemperature = 1;
constexpr double kMinTemperature = 1e-4;
// Keeps a constant score from making everything else unknown.
constexpr double kMinEvidenceDeviation = 0.5;

// Mean negative log-likelihood of the labels at `time` under a temperature.
double Loss(std::span<const ScoredContact> contacts, size_t time,
            std::span<const double> log_prior, double temperature) {
  std::vector<Outcome> outcomes;
  outcomes.reserve(contacts.size());
  for (const ScoredContact& contact : contacts) {
    Outcome outcome{contact.label, std::vector<double>(log_prior.size())};
    TemperedPosterior(log_prior, contact.log_likelihood[time], temperature,
                      outcome.probability);
    outcomes.push_back(std::move(outcome));
  }
  return NegativeLogLikelihood(outcomes);
}

// Golden-section search for the temperature, in its logarithm.
double BestTemperature(std::span<const ScoredContact> contacts, size_t time,
                       std::span<const double> log_prior) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr int kSteps = 40;
  auto loss = [&](double x) {
    return Loss(contacts, time, log_prior, std::exp(x));
  };
  double low = std::log(kMinTemperature);
  double high = std::log(kMaxTemperature);
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

}  // namespace

std::vector<double> CalibrationFrames(double rate) {
  std::vector<double> frames;
  for (double seconds : {0.1, 0.25, 0.5, 1.2, 2.5, 5.0}) {
    const double count = std::max(1.0, std::round(seconds * rate));
    if (frames.empty() || count > frames.back()) frames.push_back(count);
  }
  return frames;
}

ScoredContact ScoreContact(const std::shared_ptr<const CompiledModel>& model,
                           const Contact& contact, int label) {
  ScoredContact scored;
  scored.label = label;
  ContactClassifier classifier(model, {});
  auto record = [&] {
    const auto scores = classifier.log_likelihood();
    scored.log_likelihood.emplace_back(scores.begin(), scores.end());
    scored.frames.push_back(static_cast<double>(classifier.frames()));
  };
  const auto times = CalibrationFrames(contact.sample_rate_hz);
  for (const ContactFrame& frame : contact.frames) {
    StepClassifier(frame, classifier);
    const size_t next = scored.frames.size();
    if (next < times.size() &&
        static_cast<double>(classifier.frames()) == times[next]) {
      record();
    }
  }
  while (scored.frames.size() < times.size()) record();
  return scored;
}

void FitCalibration(std::span<const ScoredContact> contacts, double rate,
                    Calibration& calibration) {
  calibration.frames = CalibrationFrames(rate);
  calibration.hmm_temperature.clear();
  calibration.evidence_mean.clear();
  calibration.evidence_deviation.clear();
  std::vector<double> log_prior;
  for (double p : calibration.prior) log_prior.push_back(std::log(p));
  for (size_t time = 0; time < calibration.frames.size(); ++time) {
    calibration.hmm_temperature.push_back(
        BestTemperature(contacts, time, log_prior));
    double sum = 0;
    double sum_of_squares = 0;
    for (const ScoredContact& contact : contacts) {
      const auto& scores = contact.log_likelihood[time];
      const double evidence = *std::max_element(scores.begin(), scores.end()) /
                              contact.frames[time];
      sum += evidence;
      sum_of_squares += evidence * evidence;
    }
    const double count = static_cast<double>(contacts.size());
    const double mean = sum / count;
    const double variance = std::max(0.0, sum_of_squares / count - mean * mean);
    calibration.evidence_mean.push_back(mean);
    calibration.evidence_deviation.push_back(
        std::max(std::sqrt(variance), kMinEvidenceDeviation));
  }
}

}  // namespace tactus
