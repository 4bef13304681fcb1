#include "core/classify/calibration.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

// Exponentiates in place relative to the largest entry and normalises.
// Returns false if no entry is above -infinity.
bool NormaliseLogs(std::span<double> values) {
  const double top = *std::max_element(values.begin(), values.end());
  if (!(top > -std::numeric_limits<double>::infinity())) return false;
  double sum = 0;
  for (double& value : values) sum += value = std::exp(value - top);
  for (double& value : values) value /= sum;
  return true;
}

absl::Status CheckTable(absl::string_view name,
                        const std::vector<double>& table, size_t entries,
                        double low, double high) {
  if (table.size() != entries) {
    return InvalidModel(absl::StrCat("calibration.", name, " size"),
                        table.size(), absl::StrCat(entries));
  }
  for (double value : table) {
    if (!(value >= low && value <= high)) {
      return InvalidModel(absl::StrCat("calibration.", name), value,
                          absl::StrCat(low, " to ", high));
    }
  }
  return absl::OkStatus();
}

// When something is decided.
absl::Status CheckRule(absl::string_view what, double threshold,
                       uint32_t frames) {
  if (!(threshold > 0.5 && threshold <= 1)) {
    return InvalidModel(absl::StrCat("calibration.", what, "_threshold"),
                        threshold, "above 0.5 and at most 1");
  }
  if (frames < 1 || frames > limits::kMaxDecisionFrames) {
    return InvalidModel(absl::StrCat("calibration.", what, "_frames"), frames,
                        absl::StrCat("1 to ", limits::kMaxDecisionFrames));
  }
  return absl::OkStatus();
}

}  // namespace

CalibrationPoint CalibrationAt(const Calibration& c, double frames) {
  const auto after = std::upper_bound(c.frames.begin(), c.frames.end(), frames);
  CalibrationPoint point;
  point.high = after - c.frames.begin();
  point.low = point.high == 0 ? 0 : point.high - 1;
  if (point.high == c.frames.size()) point.high = point.low;
  // clang 14 does not capture structured bindings.
  const size_t low = point.low;
  const size_t high = point.high;
  point.fraction = low == high ? 0
                               : std::log(frames / c.frames[low]) /
                                     std::log(c.frames[high] / c.frames[low]);
  auto read = [&](const std::vector<double>& table) {
    return table[low] + point.fraction * (table[high] - table[low]);
  };
  point.hmm_inverse_temperature = read(c.hmm_inverse_temperature);
  if (!c.lstm_inverse_temperature.empty()) {
    point.lstm_inverse_temperature = read(c.lstm_inverse_temperature);
    point.hmm_weight = read(c.hmm_weight);
    point.lstm_weight = read(c.lstm_weight);
  }
  point.evidence_median = read(c.evidence_median);
  point.evidence_deviation = read(c.evidence_deviation);
  if (!c.softest.empty()) point.softest = read(c.softest);
  return point;
}

void BiasAt(std::span<const double> table, const CalibrationPoint& point,
            std::span<double> bias) {
  const size_t classes = bias.size();
  for (size_t k = 0; k < classes; ++k) {
    const double low = table[point.low * classes + k];
    const double high = table[point.high * classes + k];
    bias[k] = low + point.fraction * (high - low);
  }
}

void TemperedPosterior(std::span<const double> log_prior,
                       std::span<const double> log_score,
                       double inverse_temperature, std::span<const double> bias,
                       std::span<double> probability) {
  const double top = *std::max_element(log_score.begin(), log_score.end());
  const bool scored = top > -std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < probability.size(); ++k) {
    // Relative to the best score first: the sums of many frames are large.
    const double score =
        scored ? inverse_temperature * (log_score[k] - top) : 0.0;
    probability[k] = log_prior[k] + score + bias[k];
  }
  if (!NormaliseLogs(probability)) {
    std::fill(probability.begin(), probability.end(),
              1.0 / static_cast<double>(probability.size()));
  }
}

void FusePosteriors(std::span<const double> hmm, std::span<const double> lstm,
                    const CalibrationPoint& point, std::span<const double> bias,
                    std::span<double> fused) {
  const auto part = [](double weight, std::span<const double> model, size_t k) {
    return weight == 0 ? 0 : weight * std::log(std::max(model[k], kMinFused));
  };
  for (size_t k = 0; k < fused.size(); ++k) {
    fused[k] = part(point.hmm_weight, hmm, k) +
               part(point.lstm_weight, lstm, k) + bias[k];
  }
  NormaliseLogs(fused);
}

double UnknownProbability(const CalibrationPoint& point, double evidence,
                          std::optional<double> log10_stiffness) {
  double log_odds =
      (point.evidence_median - evidence) / point.evidence_deviation -
      kUnknownDeviations;
  if (log10_stiffness) {
    log_odds = std::max(
        log_odds, (point.softest - *log10_stiffness) / kStiffnessDeviation);
  }
  return 1 / (1 + std::exp(-log_odds));
}

absl::Status Validate(const Calibration& c, int classes, bool has_lstm) {
  constexpr double kTiny = 1e-12;
  constexpr double kHuge = 1e12;
  constexpr double kLargestBias = 1e3;
  constexpr double kLargestWeight = 1e3;
  constexpr double kLargestLog10 = 100;
  const size_t entries = c.frames.size();
  if (entries == 0 || entries > limits::kMaxCalibrationEntries) {
    return InvalidModel("calibration.frames size", entries,
                        absl::StrCat("1 to ", limits::kMaxCalibrationEntries));
  }
  TACTUS_RETURN_IF_ERROR(CheckTable("frames", c.frames, entries, 1, kHuge));
  if (std::adjacent_find(c.frames.begin(), c.frames.end(),
                         std::greater_equal<>()) != c.frames.end()) {
    return InvalidModel("calibration.frames", "not increasing", "increasing");
  }
  TACTUS_RETURN_IF_ERROR(CheckTable("hmm_inverse_temperature",
                                    c.hmm_inverse_temperature, entries, kTiny,
                                    kHuge));
  const size_t biases = entries * static_cast<size_t>(classes);
  TACTUS_RETURN_IF_ERROR(
      CheckTable("hmm_bias", c.hmm_bias, biases, -kLargestBias, kLargestBias));
  const size_t lstm_entries = has_lstm ? entries : 0;
  const size_t lstm_biases = has_lstm ? biases : 0;
  TACTUS_RETURN_IF_ERROR(CheckTable("lstm_inverse_temperature",
                                    c.lstm_inverse_temperature, lstm_entries,
                                    kTiny, kHuge));
  TACTUS_RETURN_IF_ERROR(CheckTable("lstm_bias", c.lstm_bias, lstm_biases,
                                    -kLargestBias, kLargestBias));
  TACTUS_RETURN_IF_ERROR(
      CheckTable("hmm_weight", c.hmm_weight, lstm_entries, 0, kLargestWeight));
  TACTUS_RETURN_IF_ERROR(CheckTable("lstm_weight", c.lstm_weight, lstm_entries,
                                    0, kLargestWeight));
  TACTUS_RETURN_IF_ERROR(CheckTable("fused_bias", c.fused_bias, lstm_biases,
                                    -kLargestBias, kLargestBias));
  TACTUS_RETURN_IF_ERROR(
      CheckTable("evidence_median", c.evidence_median, entries, -kHuge, kHuge));
  TACTUS_RETURN_IF_ERROR(CheckTable("evidence_deviation", c.evidence_deviation,
                                    entries, kTiny, kHuge));
  if (!c.softest.empty() && c.softest.size() != entries) {
    return InvalidModel("calibration.softest size", c.softest.size(),
                        absl::StrCat("0 or ", entries));
  }
  TACTUS_RETURN_IF_ERROR(CheckTable("softest", c.softest, c.softest.size(),
                                    -kLargestLog10, kLargestLog10));
  TACTUS_RETURN_IF_ERROR(CheckTable("prior", c.prior, classes, 0, 1));
  double sum = 0;
  for (double p : c.prior) sum += p;
  if (std::abs(sum - 1) > 1e-9) {
    return InvalidModel("sum of calibration.prior", sum, "1");
  }
  for (double scale : {c.stiffness_deviation_scale, c.moved_deviation_scale}) {
    if (!(scale >= kTiny && scale <= kHuge)) {
      return InvalidModel("calibration deviation scale", scale,
                          absl::StrCat(kTiny, " to ", kHuge));
    }
  }
  TACTUS_RETURN_IF_ERROR(
      CheckRule("decision", c.decision_threshold, c.decision_frames));
  for (size_t q = 0; q < c.question_threshold.size(); ++q) {
    TACTUS_RETURN_IF_ERROR(
        CheckRule("question", c.question_threshold[q], c.question_frames[q]));
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal
