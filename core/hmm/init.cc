#include "core/hmm/init.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

absl::Status CheckOptions(const InitOptions& options) {
  if (options.states < 1 || options.states > limits::kMaxHmmStates) {
    return InvalidConfig("states", options.states,
                         absl::StrCat("1 to ", limits::kMaxHmmStates));
  }
  if (options.left_right && options.max_jump < 1) {
    return InvalidConfig("max_jump", options.max_jump, "1 or more");
  }
  if (!(options.covariance_floor > 0 &&
        std::isfinite(options.covariance_floor))) {
    return InvalidConfig("covariance_floor", options.covariance_floor,
                         "above 0 and finite");
  }
  return absl::OkStatus();
}

int PieceOf(int t, int frames, int pieces) {
  return static_cast<int>(static_cast<int64_t>(t) * pieces / frames);
}

void SetEmissions(const std::vector<SequenceView>& sequences, double floor,
                  GaussianHmm& model) {
  const int d = model.dimensions;
  const FrameMoments all = ComputeFrameMoments(sequences);
  std::vector<double> count(model.states, 0.0);
  model.means.assign(static_cast<size_t>(model.states) * d, 0.0);
  model.covariances.assign(model.states, 0.0);
  // Calls visit(state, frame) for every frame.
  const auto for_each = [&](auto visit) {
    for (const SequenceView& sequence : sequences) {
      for (int t = 0; t < sequence.frames; ++t) {
        visit(PieceOf(t, sequence.frames, model.states), sequence.frame(t));
      }
    }
  };
  for_each([&](int s, std::span<const double> frame) {
    ++count[s];
    for (int k = 0; k < d; ++k) model.means[s * d + k] += frame[k];
  });
  for (int s = 0; s < model.states; ++s) {
    for (int k = 0; k < d; ++k) {
      double& mean = model.means[s * d + k];
      // A piece without frames: every sequence is shorter than N.
      mean = count[s] > 0 ? mean / count[s] : all.mean[k];
    }
  }
  for_each([&](int s, std::span<const double> frame) {
    for (int k = 0; k < d; ++k) {
      const double difference = frame[k] - model.means[s * d + k];
      model.covariances[s] += difference * difference / (d * count[s]);
    }
  });
  for (int s = 0; s < model.states; ++s) {
    double& variance = model.covariances[s];
    if (count[s] == 0) {
      for (const double v : all.variance) variance += v / d;
    }
    variance = std::max(variance, floor);
  }
}

void SetTransitions(const InitOptions& options, double mean_frames,
                    GaussianHmm& model) {
  const int n = model.states;
  const double stay = std::max(0.5, 1 - n / mean_frames);
  model.transition.assign(static_cast<size_t>(n) * n, 0.0);
  for (int i = 0; i < n; ++i) {
    double* row = &model.transition[static_cast<size_t>(i) * n];
    const int first = options.left_right ? i : 0;
    const int last =
        options.left_right ? i + std::min(options.max_jump, n - 1 - i) : n - 1;
    if (first == last) {
      row[i] = 1;
      continue;
    }
    for (int j = first; j <= last; ++j) {
      row[j] = j == i ? stay : (1 - stay) / (last - first);
    }
  }
}

}  // namespace

absl::StatusOr<GaussianHmm> InitPaper(
    const std::vector<SequenceView>& sequences, const InitOptions& options) {
  TACTUS_RETURN_IF_ERROR(CheckOptions(options));
  TACTUS_RETURN_IF_ERROR(Validate(sequences));
  GaussianHmm model;
  model.states = options.states;
  model.dimensions = sequences.front().dimensions;
  model.covariance_type = CovarianceType::kSpherical;
  model.start.assign(options.states, 1.0 / options.states);
  SetEmissions(sequences, options.covariance_floor, model);
  SetTransitions(options,
                 static_cast<double>(TotalFrames(sequences)) / sequences.size(),
                 model);
  model = WithCovarianceType(model, options.covariance_type);
  TACTUS_RETURN_IF_ERROR(Validate(model));
  return model;
}

}  // namespace tactus::internal
