#include "tests/reference/classify/plain_classifier.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace tactus::internal {
namespace {

using Numbers = PlainClassifier::Numbers;

constexpr long double kNothing = -std::numeric_limits<long double>::infinity();

long double LogSum(const Numbers& logs) {
  const long double top = *std::ranges::max_element(logs);
  if (top == kNothing) return kNothing;
  long double sum = 0;
  for (const long double x : logs) sum += std::exp(x - top);
  return top + std::log(sum);
}

Numbers Normalised(const Numbers& logs) {
  const long double all = LogSum(logs);
  Numbers result;
  for (const long double x : logs) result.push_back(std::exp(x - all));
  return result;
}

// log N(x; mean, covariance) of one state, by a Cholesky factor.
long double LogDensity(const GaussianHmm& hmm, int state, const Numbers& x) {
  const int n = hmm.dimensions;
  std::vector<double> covariance(size_t(n) * n);
  FullCovariance(hmm, state, covariance.data());
  std::vector<Numbers> factor(n, Numbers(n));
  Numbers z(n);
  long double log_determinant = 0;
  long double distance = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      long double sum = covariance[size_t(i) * n + j];
      for (int k = 0; k < j; ++k) sum -= factor[i][k] * factor[j][k];
      factor[i][j] = i == j ? std::sqrt(sum) : sum / factor[j][j];
    }
    long double rest = x[i] - hmm.means[size_t(state) * n + i];
    for (int k = 0; k < i; ++k) rest -= factor[i][k] * z[k];
    z[i] = rest / factor[i][i];
    distance += z[i] * z[i];
    log_determinant += 2 * std::log(factor[i][i]);
  }
  const long double log_two_pi = std::log(2 * std::numbers::pi_v<long double>);
  return -0.5L * (distance + log_determinant + n * log_two_pi);
}

long double GateOf(GateActivation activation, long double x) {
  if (activation == GateActivation::kSigmoid) return 1 / (1 + std::exp(-x));
  return std::clamp(0.2L * x + 0.5L, 0.0L, 1.0L);
}

long double SquashOf(Activation activation, long double x) {
  if (activation == Activation::kTanh) return std::tanh(x);
  return x / (1 + std::abs(x));
}

// Reads tables of a Calibration, linear in log(frames) between entries.
class Reader {
 public:
  Reader(const Calibration& c, uint64_t frames) {
    const auto x = static_cast<long double>(frames);
    size_t i = 0;
    while (i < c.frames.size() && c.frames[i] <= x) ++i;
    high_ = std::min(i, c.frames.size() - 1);
    low_ = i == 0 ? 0 : i - 1;
    if (low_ == high_) return;
    fraction_ =
        std::log(x / c.frames[low_]) /
        std::log(static_cast<long double>(c.frames[high_]) / c.frames[low_]);
  }

  long double operator()(const std::vector<double>& table, size_t columns = 1,
                         size_t column = 0) const {
    return (1 - fraction_) * table[low_ * columns + column] +
           fraction_ * table[high_ * columns + column];
  }

 private:
  size_t low_ = 0;
  size_t high_ = 0;
  long double fraction_ = 0;
};

}  // namespace

PlainClassifier::PlainClassifier(const Model& model)
    : model_(&model),
      cues_(model.inputs.sample_rate_hz),
      hmm_clock_(model.inputs.hmm_steps),
      lstm_clock_(model.inputs.lstm_steps),
      questions_(model.questions.empty() ? DefaultQuestions(model.class_names)
                                         : model.questions) {
  Reset();
}

void PlainClassifier::Reset() {
  const Model& m = *model_;
  const auto fresh = [](const LstmNetwork& network) {
    Memory memory;
    for (const LstmLayer& layer : network.layers) {
      memory.output.emplace_back(layer.cells);
      memory.cell.emplace_back(layer.cells);
    }
    return memory;
  };
  cues_.Reset();
  frames_ = 0;
  hmm_steps_ = 0;
  hmm_clock_.Reset();
  lstm_clock_.Reset();
  watch_.Reset();
  evaluations_ = 0;
  evaluated_frame_ = 0;
  agreed_.clear();
  for (const Question& question : questions_) {
    Numbers& value = agreed_.emplace_back(question.values.size());
    for (int k = 0; k < m.classes(); ++k) {
      value[question.value_of_class[k]] += m.calibration.prior[k];
    }
  }
  last_ = before_ = agreed_;
  log_alpha_.clear();
  for (const HmmMixture& mixture : m.hmms) {
    log_alpha_.emplace_back(mixture.components.size());
  }
  memories_.clear();
  for (const LstmNetwork& network : m.lstms)
    memories_.push_back(fresh(network));
  if (m.estimator) estimator_memory_ = fresh(*m.estimator);
  log_likelihood_.assign(m.classes(), 0);
  lstm_score_.assign(m.classes(), 0);
  probability_.assign(m.calibration.prior.begin(), m.calibration.prior.end());
  hmm_probability_ = lstm_probability_ = probability_;
  unknown_ = 0;
  answered_ = false;
  object_.reset();
}

void PlainClassifier::StepOrHold(const ContactFrame& frame) {
  ++frames_;
  if (!frame.touched) return;
  cues_.Step(frame.sample, frames_);
  const bool hmms_due = hmm_clock_.Tick(frames_);
  const bool lstms_due = !model_->lstms.empty() && lstm_clock_.Tick(frames_);
  const bool left_course = watch_.Step(frame.sample);
  evaluated_now_ = false;
  if (hmms_due) StepHmms();
  if (lstms_due) StepLstms();
  if (!lstms_due && LookIsDue(left_course)) Look();
  const bool read =
      hmms_due || lstms_due || !answered_ || !model_->calibration.held;
  if (read) calibration_frame_ = frames_;
  if (read || evaluated_now_) UpdateProbabilities();
  answered_ = true;
}

Numbers PlainClassifier::Inputs(const std::vector<ModelInput>& inputs) const {
  Numbers x;
  for (const ModelInput& input : inputs) {
    long double value = cues_.Value(input.cue);
    if (input.log_offset != 0) {
      value = std::log(std::max(value, 0.0L) + input.log_offset);
    }
    x.push_back(std::clamp<long double>((value - input.offset) * input.gain,
                                        -input.limit, input.limit));
  }
  return x;
}

void PlainClassifier::StepHmms() {
  const Numbers x = Inputs(model_->inputs.hmm);
  ++hmm_steps_;
  for (int c = 0; c < model_->classes(); ++c) {
    const HmmMixture& mixture = model_->hmms[c];
    Numbers components;
    for (size_t k = 0; k < mixture.components.size(); ++k) {
      const GaussianHmm& hmm = mixture.components[k];
      Numbers& before = log_alpha_[c][k];
      Numbers now;
      for (int to = 0; to < hmm.states; ++to) {
        Numbers ways;
        for (int from = 0; from < hmm.states && !before.empty(); ++from) {
          const long double step = hmm.transition[from * hmm.states + to];
          ways.push_back(before[from] + std::log(step));
        }
        const long double arrived =
            before.empty() ? std::log(static_cast<long double>(hmm.start[to]))
                           : LogSum(ways);
        now.push_back(arrived + LogDensity(hmm, to, x));
      }
      before = now;
      components.push_back(mixture.log_weight[k] + LogSum(now));
    }
    log_likelihood_[c] = LogSum(components);
  }
}

Numbers PlainClassifier::StepNetwork(const LstmNetwork& network, Numbers x,
                                     Memory& memory) {
  for (size_t i = 0; i < network.layers.size(); ++i) {
    const LstmLayer& layer = network.layers[i];
    const Numbers before = memory.output[i];
    const auto sum = [&](int gate, int cell) {
      const int row = gate * layer.cells + cell;
      long double total = layer.bias[row];
      for (int j = 0; j < layer.inputs; ++j) {
        total += layer.kernel[size_t(row) * layer.inputs + j] * x[j];
      }
      for (int j = 0; j < layer.cells; ++j) {
        total += layer.recurrent[size_t(row) * layer.cells + j] * before[j];
      }
      return total;
    };
    for (int k = 0; k < layer.cells; ++k) {
      long double& cell = memory.cell[i][k];
      cell = GateOf(network.gate_activation, sum(1, k)) * cell +
             GateOf(network.gate_activation, sum(0, k)) *
                 SquashOf(network.activation, sum(2, k));
      memory.output[i][k] = GateOf(network.gate_activation, sum(3, k)) *
                            SquashOf(network.activation, cell);
    }
    x = memory.output[i];
  }
  Numbers outputs(network.dense_bias.begin(), network.dense_bias.end());
  for (size_t k = 0; k < outputs.size(); ++k) {
    for (size_t j = 0; j < x.size(); ++j) {
      outputs[k] += network.dense_kernel[k * x.size() + j] * x[j];
    }
  }
  return outputs;
}

bool PlainClassifier::LookIsDue(bool left_course) const {
  if (evaluations_ == 0) return false;
  bool states = false;
  bool unsure = false;
  for (size_t q = 0; q < questions_.size(); ++q) {
    if (questions_[q].kind != Question::kState) continue;
    states = true;
    unsure |= *std::ranges::max_element(agreed_[q]) < 0.95L;
  }
  return states && (unsure || (left_course && frames_ >= evaluated_frame_ + 2));
}

void PlainClassifier::Look() {
  std::vector<Memory> copy = memories_;
  lstm_score_ = ScoreOf(copy, Inputs(model_->inputs.lstm));
  ++evaluations_;
  evaluated_frame_ = frames_;
  evaluated_now_ = true;
  watch_.Restart();
}

Numbers PlainClassifier::ScoreOf(std::vector<Memory>& memories,
                                 const Numbers& x) const {
  const Model& m = *model_;
  Numbers mean(m.classes());
  for (size_t n = 0; n < m.lstms.size(); ++n) {
    Numbers outputs = StepNetwork(m.lstms[n], x, memories[n]);
    outputs.resize(m.classes());
    const Numbers probability = Normalised(outputs);
    for (int k = 0; k < m.classes(); ++k) {
      mean[k] += probability[k] / static_cast<long double>(m.lstms.size());
    }
  }
  for (long double& score : mean) score = std::log(score);
  return mean;
}

void PlainClassifier::StepLstms() {
  const Model& m = *model_;
  const Numbers x = Inputs(m.inputs.lstm);
  lstm_score_ = ScoreOf(memories_, x);
  ++evaluations_;
  evaluated_frame_ = frames_;
  evaluated_now_ = true;
  watch_.Restart();
  if (!m.estimator) return;
  const Numbers outputs = StepNetwork(*m.estimator, x, estimator_memory_);
  double regression[2];
  double deviation[2];
  const double scale[] = {m.calibration.stiffness_deviation_scale,
                          m.calibration.moved_deviation_scale};
  for (int r = 0; r < 2; ++r) {
    regression[r] = static_cast<double>(outputs[m.classes() + r]);
    deviation[r] = static_cast<double>(
        scale[r] * std::exp(0.5L * outputs[m.classes() + 2 + r]));
  }
  object_ = DecodeEstimate(regression, deviation,
                           static_cast<double>(cues_.Value(Cue::kMotion)));
}

void PlainClassifier::UpdateProbabilities() {
  const Calibration& c = model_->calibration;
  const Reader read(c, calibration_frame_);
  const auto classes = static_cast<size_t>(model_->classes());
  const auto tempered = [&](const Numbers& scores,
                            const std::vector<double>& factor,
                            const std::vector<double>& bias) {
    Numbers logs;
    for (size_t k = 0; k < classes; ++k) {
      logs.push_back(std::log(static_cast<long double>(c.prior[k])) +
                     read(factor) * scores[k] + read(bias, classes, k));
    }
    return Normalised(logs);
  };
  hmm_probability_ =
      tempered(log_likelihood_, c.hmm_inverse_temperature, c.hmm_bias);
  if (model_->lstms.empty()) {
    probability_ = hmm_probability_;
  } else {
    lstm_probability_ =
        tempered(lstm_score_, c.lstm_inverse_temperature, c.lstm_bias);
    Numbers logs;
    for (size_t k = 0; k < classes; ++k) {
      logs.push_back(read(c.hmm_weight) *
                         std::log(std::max(hmm_probability_[k], 1e-300L)) +
                     read(c.lstm_weight) *
                         std::log(std::max(lstm_probability_[k], 1e-300L)) +
                     read(c.fused_bias, classes, k));
    }
    probability_ = Normalised(logs);
  }
  AgreeOnStates();
  if (hmm_steps_ == 0) return;
  const long double evidence = *std::ranges::max_element(log_likelihood_) /
                               static_cast<long double>(hmm_steps_);
  long double log_odds =
      (read(c.evidence_median) - evidence) / read(c.evidence_deviation) - 6;
  if (object_ && !c.softest.empty()) {
    const long double stiffness = object_->log10_stiffness;
    log_odds = std::max(log_odds, (read(c.softest) - stiffness) / 0.05L);
  }
  unknown_ = 1 / (1 + std::exp(-log_odds));
}

void PlainClassifier::AgreeOnStates() {
  for (size_t q = 0; q < questions_.size(); ++q) {
    const Question& question = questions_[q];
    Numbers value(question.values.size());
    for (size_t k = 0; k < probability_.size(); ++k) {
      value[question.value_of_class[k]] += probability_[k];
    }
    if (evaluated_now_) before_[q] = last_[q];
    last_[q] = agreed_[q] = value;
    if (question.kind != Question::kState || evaluations_ == 0) continue;
    const auto best_of = [](const Numbers& p) {
      return std::ranges::max_element(p) - p.begin();
    };
    const auto best = best_of(value);
    Numbers& agreed = agreed_[q];
    if (evaluations_ > 1 && best_of(before_[q]) == best) {
      if (before_[q][best] < value[best]) agreed = before_[q];
    } else {
      Numbers halves;
      for (const long double p : value) halves.push_back(std::log(p) / 2);
      agreed = Normalised(halves);
    }
    for (size_t k = 0; k < probability_.size(); ++k) {
      const int v = question.value_of_class[k];
      probability_[k] *= agreed[v] / value[v];
    }
  }
}

}  // namespace tactus::internal
