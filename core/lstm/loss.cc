#include "core/lstm/loss.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/base/limits.h"

namespace tactus::internal {
namespace {

double CrossEntropy(const LstmLossOptions& options, int classes,
                    const float* logits, int label, double scale,
                    float* gradient) {
  const double largest = *std::max_element(logits, logits + classes);
  double powers[limits::kMaxClasses];
  double sum = 0;
  for (int k = 0; k < classes; ++k) {
    powers[k] = std::exp(logits[k] - largest);
    sum += powers[k];
  }
  const double log_sum = largest + std::log(sum);
  const double spread = options.label_smoothing / classes;
  double loss = 0;
  for (int k = 0; k < classes; ++k) {
    const double want =
        spread + (k == label ? 1 - options.label_smoothing : 0.0);
    loss += want * (log_sum - logits[k]);
    gradient[k] = static_cast<float>(scale * (powers[k] / sum - want));
  }
  return scale * loss;
}

double GaussianLoss(double mean, double log_variance, double target,
                    double scale, float& by_mean, float& by_log_variance) {
  const double precision = std::exp(-log_variance);
  const double error = mean - target;
  by_mean = static_cast<float>(scale * error * precision);
  by_log_variance =
      static_cast<float>(scale * 0.5 * (1 - error * error * precision));
  return scale * 0.5 * (log_variance + error * error * precision);
}

}  // namespace

absl::Status Validate(const LstmLossOptions& options) {
  if (options.first_step < 0) {
    return InvalidConfig("first_step", options.first_step, "at least 0");
  }
  if (options.stride < 1) {
    return InvalidConfig("stride", options.stride, "at least 1");
  }
  if (!(options.label_smoothing >= 0 && options.label_smoothing < 1)) {
    return InvalidConfig("label_smoothing", options.label_smoothing,
                         "at least 0 and below 1");
  }
  if (!(options.regression_weight >= 0 &&
        std::isfinite(options.regression_weight))) {
    return InvalidConfig("regression_weight", options.regression_weight,
                         "finite and at least 0");
  }
  return absl::OkStatus();
}

bool Counts(const LstmLossOptions& options, int t, int steps) {
  if (t == steps - 1) return true;
  return options.steps == LstmLoss::kEveryStep && t >= options.first_step &&
         (t - options.first_step) % options.stride == 0;
}

double StepLoss(const LstmLossOptions& options, int classes, int regressions,
                const float* outputs, int label, std::span<const float> targets,
                double scale, float* gradient) {
  double loss = CrossEntropy(options, classes, outputs, label, scale, gradient);
  const float* mean = outputs + classes;
  const float* log_variance = mean + regressions;
  float* by_mean = gradient + classes;
  float* by_log_variance = by_mean + regressions;
  for (size_t r = 0; r < targets.size(); ++r) {
    loss += GaussianLoss(mean[r], log_variance[r], targets[r],
                         scale * options.regression_weight, by_mean[r],
                         by_log_variance[r]);
  }
  return loss;
}

}  // namespace tactus::internal
