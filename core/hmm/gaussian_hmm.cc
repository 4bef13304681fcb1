#include "core/hmm/gaussian_hmm.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "Eigen/Cholesky"
#include "Eigen/Core"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

constexpr double kSumTolerance = 1e-9;
constexpr double kSymmetryTolerance = 1e-9;

std::string Entry(absl::string_view field, size_t row, size_t column) {
  return absl::StrCat(field, "[", row, "][", column, "]");
}

absl::Status CheckSize(absl::string_view field, size_t got, size_t want) {
  if (got == want) return absl::OkStatus();
  return InvalidModel(absl::StrCat(field, " size"), got,
                      absl::StrCat(want, " numbers"));
}

absl::Status CheckFinite(absl::string_view field,
                         const std::vector<double>& values, size_t width) {
  for (size_t k = 0; k < values.size(); ++k) {
    if (!std::isfinite(values[k])) {
      return InvalidModel(Entry(field, k / width, k % width), values[k],
                          "a finite number");
    }
  }
  return absl::OkStatus();
}

absl::Status CheckDistribution(const std::string& field,
                               const double* probability, int count) {
  double sum = 0;
  for (int k = 0; k < count; ++k) {
    const double p = probability[k];
    if (!(p >= 0 && p <= 1 + kSumTolerance)) {
      return InvalidModel(absl::StrCat(field, "[", k, "]"), p,
                          "a probability, 0 to 1");
    }
    sum += p;
  }
  if (std::abs(sum - 1) > kSumTolerance) {
    return InvalidModel(absl::StrCat(field, " sum"), sum, "1");
  }
  return absl::OkStatus();
}

absl::Status CheckFullCovariance(const GaussianHmm& model, int state) {
  const int d = model.dimensions;
  const double* c = &model.covariances[static_cast<size_t>(state) * d * d];
  for (int i = 0; i < d; ++i) {
    for (int j = 0; j < i; ++j) {
      const double scale =
          std::sqrt(std::abs(c[i * d + i])) * std::sqrt(std::abs(c[j * d + j]));
      if (std::abs(c[i * d + j] - c[j * d + i]) > kSymmetryTolerance * scale) {
        return InvalidModel(
            absl::StrCat("covariances[", state, "][", i, "][", j, "]"),
            c[i * d + j], "equal to its mirror image");
      }
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> cholesky(
      Eigen::Map<const Eigen::MatrixXd>(c, d, d));
  if (cholesky.info() != Eigen::Success ||
      !cholesky.matrixLLT().diagonal().allFinite() ||
      !(cholesky.matrixLLT().diagonal().minCoeff() > 0)) {
    return InvalidModel(absl::StrCat("covariances[", state, "]"),
                        "not positive definite", "positive definite");
  }
  return absl::OkStatus();
}

absl::Status CheckCovariances(const GaussianHmm& model) {
  const size_t width = CovarianceSize(model.covariance_type, model.dimensions);
  TACTUS_RETURN_IF_ERROR(CheckFinite("covariances", model.covariances, width));
  for (int s = 0; s < model.states; ++s) {
    if (model.covariance_type == CovarianceType::kFull) {
      TACTUS_RETURN_IF_ERROR(CheckFullCovariance(model, s));
      continue;
    }
    for (size_t k = 0; k < width; ++k) {
      const double variance = model.covariances[s * width + k];
      if (!(variance > 0)) {
        return InvalidModel(Entry("covariances", s, k), variance, "above 0");
      }
    }
  }
  return absl::OkStatus();
}

}  // namespace

size_t CovarianceSize(CovarianceType type, int dimensions) {
  const size_t d = static_cast<size_t>(dimensions);
  switch (type) {
    case CovarianceType::kFull:
      return d * d;
    case CovarianceType::kDiagonal:
      return d;
    case CovarianceType::kSpherical:
      break;
  }
  return 1;
}

absl::Status Validate(const GaussianHmm& model) {
  if (model.states < 1 || model.states > limits::kMaxHmmStates) {
    return InvalidModel("states", model.states,
                        absl::StrCat("1 to ", limits::kMaxHmmStates));
  }
  if (model.dimensions < 1 || model.dimensions > limits::kMaxHmmDimensions) {
    return InvalidModel("dimensions", model.dimensions,
                        absl::StrCat("1 to ", limits::kMaxHmmDimensions));
  }
  const int type = static_cast<int>(model.covariance_type);
  if (type < 0 || type > static_cast<int>(CovarianceType::kSpherical)) {
    return InvalidModel("covariance_type", type, "full, diagonal, spherical");
  }
  const size_t n = static_cast<size_t>(model.states);
  const size_t d = static_cast<size_t>(model.dimensions);
  TACTUS_RETURN_IF_ERROR(CheckSize("start", model.start.size(), n));
  TACTUS_RETURN_IF_ERROR(
      CheckSize("transition", model.transition.size(), n * n));
  TACTUS_RETURN_IF_ERROR(CheckSize("means", model.means.size(), n * d));
  TACTUS_RETURN_IF_ERROR(
      CheckSize("covariances", model.covariances.size(),
                n * CovarianceSize(model.covariance_type, model.dimensions)));
  TACTUS_RETURN_IF_ERROR(
      CheckDistribution("start", model.start.data(), model.states));
  for (int s = 0; s < model.states; ++s) {
    TACTUS_RETURN_IF_ERROR(
        CheckDistribution(absl::StrCat("transition[", s, "]"),
                          &model.transition[s * n], model.states));
  }
  TACTUS_RETURN_IF_ERROR(CheckFinite("means", model.means, d));
  return CheckCovariances(model);
}

void FullCovariance(const GaussianHmm& model, int state, double* out) {
  const int d = model.dimensions;
  const size_t width = CovarianceSize(model.covariance_type, d);
  const double* c = &model.covariances[state * width];
  if (model.covariance_type == CovarianceType::kFull) {
    std::copy(c, c + width, out);
    return;
  }
  std::fill(out, out + d * d, 0.0);
  for (int i = 0; i < d; ++i) {
    out[i * d + i] =
        c[model.covariance_type == CovarianceType::kDiagonal ? i : 0];
  }
}

GaussianHmm WithCovarianceType(const GaussianHmm& model, CovarianceType type) {
  GaussianHmm out = model;
  out.covariance_type = type;
  const int d = model.dimensions;
  const size_t width = CovarianceSize(type, d);
  out.covariances.assign(model.states * width, 0.0);
  std::vector<double> full(static_cast<size_t>(d) * d);
  for (int s = 0; s < model.states; ++s) {
    FullCovariance(model, s, full.data());
    double* c = &out.covariances[s * width];
    if (type == CovarianceType::kFull) {
      std::copy(full.begin(), full.end(), c);
      continue;
    }
    for (int i = 0; i < d; ++i) {
      const double variance = full[i * d + i];
      if (type == CovarianceType::kDiagonal) {
        c[i] = variance;
      } else {
        c[0] += variance / d;
      }
    }
  }
  return out;
}

}  // namespace tactus::internal
