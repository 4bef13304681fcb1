#include "core/lstm/optimizer.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/lstm/tensors.h"
#include "core/lstm/vector_math.h"

namespace tactus::internal {
namespace {

// Mean squares below count as 0: they would fade into the denormal numbers,
// which are slow.
constexpr float kTiny = 1e-30F;

struct Rates {
  float mean;
  float mean_square;
  float step;         // learning rate, corrected for the bias of the mean
  float root_factor;  // corrects the root of the mean square
  float epsilon;
};

TACTUS_INLINE void RmsProp(const Rates& rates, const float* __restrict gradient,
                           float* __restrict mean_square, size_t count,
                           float* __restrict weights) {
  for (size_t i = 0; i < count; ++i) {
    const float square = gradient[i] * gradient[i];
    float v = rates.mean_square * mean_square[i] +
              (1.0F - rates.mean_square) * square;
    v = v < kTiny ? 0.0F : v;
    mean_square[i] = v;
    weights[i] -= rates.step * gradient[i] / (std::sqrt(v) + rates.epsilon);
  }
}

TACTUS_INLINE void Adam(const Rates& rates, const float* __restrict gradient,
                        float* __restrict mean, float* __restrict mean_square,
                        size_t count, float* __restrict weights) {
  for (size_t i = 0; i < count; ++i) {
    const float g = gradient[i];
    float m = rates.mean * mean[i] + (1.0F - rates.mean) * g;
    float v = rates.mean_square * mean_square[i] +
              (1.0F - rates.mean_square) * (g * g);
    m = std::abs(m) < kTiny ? 0.0F : m;
    v = v < kTiny ? 0.0F : v;
    mean[i] = m;
    mean_square[i] = v;
    weights[i] -=
        rates.step * m / (std::sqrt(v) * rates.root_factor + rates.epsilon);
  }
}

// Adds the squares of values i, i + kSums, i + 2 kSums .. to sums[i].
constexpr size_t kSums = 16;
TACTUS_INLINE void AddSquares(const float* __restrict values, size_t count,
                              double* __restrict sums) {
  size_t i = 0;
  for (; i + kSums <= count; i += kSums) {
    for (size_t j = 0; j < kSums; ++j) {
      sums[j] += double{values[i + j]} * double{values[i + j]};
    }
  }
  for (size_t j = 0; i + j < count; ++j) {
    sums[j] += double{values[i + j]} * double{values[i + j]};
  }
}

// The loops above for one instruction set. The compiler vectorises them; each
// number results from the same operations at any width.
struct Loops {
  void (*rms_prop)(const Rates&, const float*, float*, size_t, float*);
  void (*adam)(const Rates&, const float*, float*, float*, size_t, float*);
  void (*add_squares)(const float*, size_t, double*);
};

#define TACTUS_LOOPS(Name, target)                                             \
  struct Name {                                                                \
    target static void Rms(const Rates& rates, const float* gradient,          \
                           float* mean_square, size_t count, float* weights) { \
      RmsProp(rates, gradient, mean_square, count, weights);                   \
    }                                                                          \
    target static void AdamStep(const Rates& rates, const float* gradient,     \
                                float* mean, float* mean_square, size_t count, \
                                float* weights) {                              \
      Adam(rates, gradient, mean, mean_square, count, weights);                \
    }                                                                          \
    target static void Squares(const float* values, size_t count,              \
                               double* sums) {                                 \
      AddSquares(values, count, sums);                                         \
    }                                                                          \
    static constexpr Loops kLoops = {&Rms, &AdamStep, &Squares};               \
  };

TACTUS_LOOPS(Baseline, )
#ifdef __x86_64__
TACTUS_LOOPS(Avx2, [[gnu::target("avx2")]])
#ifdef __clang__
// It does not know the attribute's second part.
TACTUS_LOOPS(Avx512, [[gnu::target("avx512f")]])
#else
TACTUS_LOOPS(Avx512, [[gnu::target("avx512f,prefer-vector-width=512")]])
#endif
#endif

const Loops& BestLoops() {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f")) return Avx512::kLoops;
  if (__builtin_cpu_supports("avx2")) return Avx2::kLoops;
#endif
  return Baseline::kLoops;
}

Rates RatesOf(const OptimizerOptions& options, double learning_rate,
              int64_t steps) {
  const auto narrow = [](double value) { return static_cast<float>(value); };
  if (options.optimizer == Optimizer::kRmsProp) {
    return {0, narrow(options.rms_decay), narrow(learning_rate), 1,
            narrow(options.epsilon)};
  }
  const auto n = static_cast<double>(steps);
  const double first = 1 - std::pow(options.first_decay, n);
  const double second = 1 - std::pow(options.second_decay, n);
  return {narrow(options.first_decay), narrow(options.second_decay),
          narrow(learning_rate / first), narrow(1 / std::sqrt(second)),
          narrow(options.epsilon)};
}

absl::Status CheckShare(absl::string_view field, double value) {
  if (value >= 0 && value < 1) return absl::OkStatus();
  return InvalidConfig(field, value, "at least 0 and below 1");
}

absl::Status CheckSize(absl::string_view field, double value) {
  if (value >= 0 && std::isfinite(value)) return absl::OkStatus();
  return InvalidConfig(field, value, "finite and at least 0");
}

}  // namespace

absl::Status Validate(const OptimizerOptions& options) {
  TACTUS_RETURN_IF_ERROR(CheckSize("learning_rate", options.learning_rate));
  TACTUS_RETURN_IF_ERROR(CheckShare("rms_decay", options.rms_decay));
  TACTUS_RETURN_IF_ERROR(CheckShare("first_decay", options.first_decay));
  TACTUS_RETURN_IF_ERROR(CheckShare("second_decay", options.second_decay));
  if (!(options.epsilon > 0 && options.epsilon <= 1)) {
    return InvalidConfig("epsilon", options.epsilon, "above 0 and at most 1");
  }
  TACTUS_RETURN_IF_ERROR(CheckSize("weight_decay", options.weight_decay));
  return CheckSize("gradient_clip", options.gradient_clip);
}

double ClipGradient(double longest, LstmNetwork& gradient) {
  std::array<double, kSums> sums = {};
  ForEachTensor(gradient, [&](const std::vector<float>& values, bool) {
    BestLoops().add_squares(values.data(), values.size(), sums.data());
  });
  const double norm = std::sqrt(std::accumulate(sums.begin(), sums.end(), 0.0));
  if (longest == 0 || norm <= longest) return norm;
  const auto factor = static_cast<float>(longest / norm);
  ForEachTensor(gradient, [&](std::vector<float>& values, bool) {
    for (float& value : values) value *= factor;
  });
  return norm;
}

void OptimizerStep(const OptimizerOptions& options, double learning_rate,
                   const LstmNetwork& gradient, OptimizerState& state,
                   LstmNetwork& network) {
  const bool adam = options.optimizer == Optimizer::kAdam;
  state.mean_square.resize(network.parameter_count());
  if (adam) state.mean.resize(network.parameter_count());
  ++state.steps;
  const Rates rates = RatesOf(options, learning_rate, state.steps);
  const auto kept =
      static_cast<float>(1 - learning_rate * options.weight_decay);
  std::vector<const float*> gradients;
  ForEachTensor(gradient, [&](const std::vector<float>& values, bool) {
    gradients.push_back(values.data());
  });
  size_t tensor = 0;
  size_t at = 0;
  ForEachTensor(network, [&](std::vector<float>& weights, bool is_kernel) {
    if (is_kernel && kept != 1) {
      for (float& weight : weights) weight *= kept;
    }
    const float* g = gradients[tensor++];
    if (adam) {
      BestLoops().adam(rates, g, &state.mean[at], &state.mean_square[at],
                       weights.size(), weights.data());
    } else {
      BestLoops().rms_prop(rates, g, &state.mean_square[at], weights.size(),
                           weights.data());
    }
    at += weights.size();
  });
}

}  // namespace tactus::internal
