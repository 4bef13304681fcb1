#include "core/train/calibrate.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>

#include "core/classify/calibration.h"
#include "core/classify/contact_classifier.h"
#include "core/contacts/anytime.h"
#include "core/train/fit_unknown.h"
#include "core/train/softmax_fit.h"

namespace tactus::internal {
namespace {

// Keeps divisions finite.
constexpr double kMinDeviation = 1e-12;
// Scales of deviations are at least this, and at most its inverse.
constexpr double kMinScale = 0.01;
// Keeps one contact whose label has probability 0 from deciding everything.
constexpr double kMinProbability = 1e-12;

using Scores = std::vector<std::vector<double>>;

// HMMs are never made more confident, because frames are not independent.
constexpr WeightBounds kHmmBounds = {1e-4, 1};
// The scores of a ridge are about 0 and 1, those of nearest neighbours
// logarithms of distances that are about 1.
constexpr WeightBounds kBoundedBounds = {1e-2, 100};
constexpr double kBoundedSharpness = 8;
constexpr WeightBounds kLstmBounds = {1e-4, 4};
// Bounds of the tempered log-probabilities' weights in the fused answer.
constexpr WeightBounds kFusedBounds = {0, 2};
// Held-out contacts are split into this many parts, each scored by a fusion
// that is fitted to the others.
constexpr size_t kFusionParts = 4;

// The scores of one model at one time.
std::vector<ScoredLabel> ScoresAt(std::span<const ScoredContact> contacts,
                                  Scores ScoredContact::*scores, size_t time) {
  std::vector<ScoredLabel> at;
  at.reserve(contacts.size());
  for (const ScoredContact& contact : contacts) {
    at.push_back({contact.labels[time], {(contact.*scores)[time]}});
  }
  return at;
}

// The answer of one model at one time.
struct Member {
  SoftmaxFit fit;
  // Each contact's tempered log-probabilities, and the loss of its label.
  std::vector<std::vector<double>> log_probability;
  std::vector<double> loss;
};

Member FitMember(std::span<const ScoredContact> contacts,
                 Scores ScoredContact::*scores, size_t time,
                 const WeightBounds& bounds,
                 std::span<const double> log_prior) {
  const std::vector<ScoredLabel> at = ScoresAt(contacts, scores, time);
  const int classes = static_cast<int>(log_prior.size());
  Member member;
  member.fit = FitSoftmax(at, {&bounds, 1}, classes);
  std::vector<double> probability(classes);
  for (const ScoredLabel& contact : at) {
    TemperedPosterior(log_prior, contact.scores[0], member.fit.weights[0],
                      member.fit.bias, probability);
    auto& logs = member.log_probability.emplace_back();
    for (const double p : probability) {
      logs.push_back(std::log(std::max(p, kMinFused)));
    }
    member.loss.push_back(-logs[contact.label]);
  }
  return member;
}

// HMMs and LSTMs together at one time.
struct Fusion {
  SoftmaxFit fit;
  // Each contact's loss, by a fusion that is fitted to other contacts.
  std::vector<double> loss;
};

Fusion FitFusion(std::span<const ScoredContact> contacts, size_t time,
                 const Member& hmm, const Member& lstm, int classes) {
  std::vector<ScoredLabel> both;
  for (size_t i = 0; i < contacts.size(); ++i) {
    both.push_back({contacts[i].labels[time],
                    {hmm.log_probability[i], lstm.log_probability[i]}});
  }
  const WeightBounds bounds[] = {kFusedBounds, kFusedBounds};
  Fusion fusion;
  fusion.fit = FitSoftmax(both, bounds, classes);
  fusion.loss.resize(both.size());
  // Contacts come fold by fold, so that a part is mostly of other conditions
  // than the rest.
  for (size_t part = 0; part < kFusionParts; ++part) {
    const size_t begin = part * both.size() / kFusionParts;
    const size_t end = (part + 1) * both.size() / kFusionParts;
    std::vector<ScoredLabel> rest(both.begin(), both.begin() + begin);
    rest.insert(rest.end(), both.begin() + end, both.end());
    if (rest.empty()) rest = both;
    const SoftmaxFit fit = FitSoftmax(rest, bounds, classes);
    for (size_t i = begin; i < end; ++i) fusion.loss[i] = LogLoss(fit, both[i]);
  }
  return fusion;
}

// True if `loss` is below `other` by more than one standard error of the
// difference. Both have one entry per contact.
bool ClearlyBelow(std::span<const double> loss, std::span<const double> other) {
  double mean = 0;
  double squares = 0;
  for (size_t i = 0; i < loss.size(); ++i) {
    const double change = (other[i] - loss[i]) - mean;
    mean += change / static_cast<double>(i + 1);
    squares += change * ((other[i] - loss[i]) - mean);
  }
  const auto count = static_cast<double>(loss.size());
  return mean > std::sqrt(squares) / count;
}

void Add(std::span<const double> values, std::vector<double>& sums) {
  sums.resize(values.size());
  for (size_t i = 0; i < values.size(); ++i) sums[i] += values[i];
}

void Append(std::span<const double> values, std::vector<double>& table) {
  table.insert(table.end(), values.begin(), values.end());
}

// Fits HMMs and LSTMs apart and together, time by time, and chooses one answer
// for all times.
void FitAnswers(std::span<const ScoredContact> contacts, Calibration& c) {
  std::vector<double> log_prior;
  for (double p : c.prior) log_prior.push_back(std::log(p));
  const int classes = static_cast<int>(log_prior.size());
  const bool has_lstm = !contacts.front().lstm_score.empty();
  std::vector<Fusion> fusions;
  std::vector<double> hmm_loss;
  std::vector<double> lstm_loss;
  std::vector<double> fused_loss;
  for (size_t time = 0; time < c.frames.size(); ++time) {
    const Member hmm = FitMember(
        contacts, &ScoredContact::log_likelihood, time,
        contacts.front().bounded ? kBoundedBounds : kHmmBounds, log_prior);
    c.hmm_inverse_temperature.push_back(hmm.fit.weights[0]);
    Append(hmm.fit.bias, c.hmm_bias);
    if (!has_lstm) continue;
    const Member lstm = FitMember(contacts, &ScoredContact::lstm_score, time,
                                  kLstmBounds, log_prior);
    c.lstm_inverse_temperature.push_back(lstm.fit.weights[0]);
    Append(lstm.fit.bias, c.lstm_bias);
    fusions.push_back(FitFusion(contacts, time, hmm, lstm, classes));
    Add(hmm.loss, hmm_loss);
    Add(lstm.loss, lstm_loss);
    Add(fusions.back().loss, fused_loss);
  }
  if (!has_lstm) return;
  const double hmm_sum = std::reduce(hmm_loss.begin(), hmm_loss.end());
  const double lstm_sum = std::reduce(lstm_loss.begin(), lstm_loss.end());
  const bool hmm_is_better = hmm_sum < lstm_sum;
  const bool fuse =
      ClearlyBelow(fused_loss, hmm_is_better ? hmm_loss : lstm_loss);
  for (const Fusion& fusion : fusions) {
    if (fuse) {
      c.hmm_weight.push_back(fusion.fit.weights[0]);
      c.lstm_weight.push_back(fusion.fit.weights[1]);
      Append(fusion.fit.bias, c.fused_bias);
    } else {
      c.hmm_weight.push_back(hmm_is_better ? 1 : 0);
      c.lstm_weight.push_back(hmm_is_better ? 0 : 1);
      c.fused_bias.resize(c.fused_bias.size() + classes);
    }
  }
}

// The calibrated answer to a scored contact at one of the calibration's times.
void PosteriorAt(const ScoredContact& contact, size_t time,
                 std::span<const double> log_prior, const Calibration& c,
                 std::span<double> probability) {
  const size_t classes = log_prior.size();
  const auto bias = [&](const std::vector<double>& table) {
    return std::span(table).subspan(time * classes, classes);
  };
  TemperedPosterior(log_prior, contact.log_likelihood[time],
                    c.hmm_inverse_temperature[time], bias(c.hmm_bias),
                    probability);
  if (contact.lstm_score.empty()) return;
  const std::vector<double> hmm(probability.begin(), probability.end());
  std::vector<double> lstm(classes);
  TemperedPosterior(log_prior, contact.lstm_score[time],
                    c.lstm_inverse_temperature[time], bias(c.lstm_bias), lstm);
  const CalibrationPoint weights = {.hmm_weight = c.hmm_weight[time],
                                    .lstm_weight = c.lstm_weight[time]};
  FusePosteriors(hmm, lstm, weights, bias(c.fused_bias), probability);
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

std::vector<double> CalibrationFrames(double rate,
                                      const StepIntervals& lstm_steps,
                                      size_t longest) {
  std::vector<double> distinct;
  for (const double early_s : {0.01, 0.03}) {
    const double frame = std::max(1.0, std::round(early_s * rate));
    if (lstm_steps.first > 0 && frame >= lstm_steps.first) {
      distinct.push_back(frame);
    }
  }
  std::ranges::copy(AnytimeFrames(rate), std::back_inserter(distinct));
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  while (distinct.back() < static_cast<double>(longest)) {
    distinct.push_back(2 * distinct.back());
  }
  return distinct;
}

ScoredContact ScoreContact(const std::shared_ptr<const CompiledModel>& model,
                           const LabelledContact& contact,
                           const std::vector<double>& frames) {
  ScoredContact scored;
  scored.bounded = !HasHmms(model->model());
  const std::vector<std::string>& names = model->model().class_names;
  const bool so_far = model->model().truth == Truth::kSoFar;
  ContactClassifier classifier(model, {});
  auto record = [&] {
    const std::string label =
        so_far ? LabelSoFar(contact, classifier.frames() - 1) : contact.label;
    scored.labels.push_back(
        static_cast<int>(std::ranges::find(names, label) - names.begin()));
    const auto scores = classifier.log_likelihood();
    scored.log_likelihood.emplace_back(scores.begin(), scores.end());
    const auto lstm = classifier.lstm_score();
    if (!lstm.empty()) scored.lstm_score.emplace_back(lstm.begin(), lstm.end());
    if (classifier.object() && !contact.object_motion.empty()) {
      scored.estimates.push_back(
          {*classifier.object(), std::log10(contact.stiffness),
           contact.object_motion[classifier.frames() - 1]});
    }
    scored.hmm_steps.push_back(classifier.evidence_steps());
    if (model->estimator() != nullptr) {
      scored.log10_stiffness.push_back(
          classifier.object() ? classifier.object()->log10_stiffness
                              : std::numeric_limits<double>::quiet_NaN());
    }
  };
  size_t next = 0;
  WalkFrames(contact, classifier, [&](size_t) {
    for (; next < frames.size() &&
           static_cast<double>(classifier.frames()) >= frames[next];
         ++next) {
      record();
    }
  });
  for (; next < frames.size(); ++next) record();
  return scored;
}

HeldOutSkill SkillOf(std::span<const ScoredContact> contacts) {
  HeldOutSkill skill;
  for (const ScoredContact& contact : contacts) {
    const std::vector<double>& scores = contact.log_likelihood.back();
    const std::vector<double> zeros(scores.size(), 0.0);
    std::vector<double> probability(scores.size());
    TemperedPosterior(zeros, scores, contact.bounded ? kBoundedSharpness : 1,
                      zeros, probability);
    if (!contact.lstm_score.empty()) {
      std::vector<double> lstm(scores.size());
      TemperedPosterior(zeros, contact.lstm_score.back(), 1, zeros, lstm);
      const CalibrationPoint even = {.hmm_weight = 0.5, .lstm_weight = 0.5};
      FusePosteriors(std::vector<double>(probability), lstm, even, zeros,
                     probability);
    }
    const int label = contact.labels.back();
    skill.accuracy +=
        std::ranges::max_element(probability) - probability.begin() == label;
    skill.loss -= std::log(std::max(probability[label], kMinProbability));
  }
  const auto count = static_cast<double>(contacts.size());
  return {skill.loss / count, skill.accuracy / count};
}

void FitCalibration(std::span<const ScoredContact> contacts,
                    const std::vector<double>& frames,
                    Calibration& calibration) {
  Calibration& c = calibration;
  c.held = true;
  c.frames = frames;
  for (auto* table :
       {&c.hmm_inverse_temperature, &c.hmm_bias, &c.lstm_inverse_temperature,
        &c.lstm_bias, &c.hmm_weight, &c.lstm_weight, &c.fused_bias}) {
    table->clear();
  }
  FitUnknown(contacts, c);
  FitAnswers(contacts, c);
  FitEstimateScales(contacts, c);
}

void HoldTheBestAnswer(std::span<const ScoredContact> contacts,
                       Calibration& calibration) {
  Calibration& c = calibration;
  std::vector<double> log_prior;
  for (const double p : c.prior) log_prior.push_back(std::log(p));
  std::vector<double> probability(c.prior.size());
  int most = -1;
  size_t best = 0;
  for (size_t time = 0; time < c.frames.size(); ++time) {
    int right = 0;
    for (const ScoredContact& contact : contacts) {
      PosteriorAt(contact, time, log_prior, c, probability);
      right += std::ranges::max_element(probability) - probability.begin() ==
               contact.labels[time];
    }
    // The last of equal ones, so that no evidence is lost without need.
    if (right < most) continue;
    most = right;
    best = time;
  }
  c.hold_after_frames =
      best + 1 < c.frames.size() ? static_cast<uint32_t>(c.frames[best]) : 0;
}

void PresumeEvenShares(std::span<const ScoredContact> contacts,
                       Calibration& calibration) {
  Calibration& c = calibration;
  const size_t classes = c.prior.size();
  std::vector<double> count(classes);
  for (const ScoredContact& contact : contacts) ++count[contact.labels.back()];
  for (size_t time = 0; time < c.frames.size(); ++time) {
    for (size_t k = 0; k < classes; ++k) {
      // A class that no contact has keeps its probability.
      if (count[k] == 0) continue;
      const double log_share =
          std::log(count[k] / static_cast<double>(contacts.size()));
      const size_t at = time * classes + k;
      c.hmm_bias[at] -= log_share;
      if (c.lstm_bias.empty()) continue;
      c.lstm_bias[at] -= log_share;
      // Both members are divided already, by as much as they count.
      c.fused_bias[at] +=
          (c.hmm_weight[time] + c.lstm_weight[time] - 1) * log_share;
    }
  }
}

}  // namespace tactus::internal
