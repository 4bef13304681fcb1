#include "core/interchange/hmm/hmm_fields.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

constexpr double kExactSum = 1e-9;
constexpr double kRoundedSum = 1e-6;

absl::Status CheckShape(const char* name, const NumberArray& array,
                        const std::vector<size_t>& want) {
  if (array.shape == want) return absl::OkStatus();
  return InvalidModel(absl::StrCat("shape of ", name),
                      absl::StrCat("(", absl::StrJoin(array.shape, ", "), ")"),
                      absl::StrCat("(", absl::StrJoin(want, ", "), ")"));
}

absl::Status CheckFinite(const char* name, const NumberArray& array) {
  for (size_t i = 0; i < array.values.size(); ++i) {
    const double value = array.values[i];
    if (std::isfinite(value)) continue;
    return InvalidModel(
        ElementName(name, array.shape, i),
        std::isnan(value) ? "NaN" : (value > 0 ? "Infinity" : "-Infinity"),
        "a finite number; the training of this model has failed");
  }
  return absl::OkStatus();
}

// A last state without transitions stays for ever.
absl::Status FillLastRow(size_t n, std::vector<double>& transmat) {
  for (size_t s = 0; s < n; ++s) {
    const auto row = transmat.begin() + static_cast<ptrdiff_t>(s * n);
    if (std::any_of(row, row + static_cast<ptrdiff_t>(n),
                    [](double p) { return p != 0; })) {
      continue;
    }
    if (s + 1 < n) {
      return InvalidModel(
          absl::StrCat(kTransMat, "[", s, "]"), "a row of zeros",
          absl::StrCat(
              "a row that sums to 1; only the last state's may be zero, "
              "which is then never left. If state ",
              s, " is never left, set ", kTransMat, "[", s, "][", s, "] to 1"));
    }
    row[static_cast<ptrdiff_t>(s)] = 1;
  }
  return absl::OkStatus();
}

// Makes each row of `size` probabilities sum to 1 if rounding alone keeps it
// from that.
void NormaliseRounded(size_t size, std::vector<double>& values) {
  for (size_t begin = 0; begin + size <= values.size(); begin += size) {
    double sum = 0;
    for (size_t i = 0; i < size; ++i) sum += values[begin + i];
    const double error = std::abs(sum - 1);
    if (error <= kExactSum || !(error <= kRoundedSum)) continue;
    for (size_t i = 0; i < size; ++i) values[begin + i] /= sum;
  }
}

// What `type` keeps of N x D x D covariances. Entries that it does not keep
// must be 0, and those that it has in common must agree.
absl::StatusOr<std::vector<double>> Reduced(const std::vector<double>& full,
                                            size_t n, size_t d,
                                            CovarianceType type) {
  std::vector<double> kept;
  for (size_t s = 0; s < n; ++s) {
    const double* block = &full[s * d * d];
    for (size_t i = 0; i < d * d; ++i) {
      const bool diagonal = i % (d + 1) == 0;
      const double want =
          !diagonal
              ? 0
              : (type == CovarianceType::kSpherical ? block[0] : block[i]);
      if (block[i] != want) {
        return InvalidModel(
            absl::StrCat(kCovars, " of state ", s), block[i],
            absl::StrCat(want, " at entry ", i, ", as covariance_type says"));
      }
      if (diagonal && (type == CovarianceType::kDiagonal || i == 0)) {
        kept.push_back(block[i]);
      }
    }
  }
  return kept;
}

absl::Status TakeCovariances(const HmmFields& fields, GaussianHmm* hmm) {
  const size_t n = hmm->states;
  const size_t d = hmm->dimensions;
  const NumberArray& covars = fields.covars;
  const std::string& type = fields.covariance_type;
  const std::vector<size_t> full = {n, d, d};
  hmm->covariances = covars.values;
  if (type == "full") return CheckShape(kCovars, covars, full);
  if (type == "tied") {
    if (covars.shape == full) return absl::OkStatus();
    TACTUS_RETURN_IF_ERROR(CheckShape(kCovars, covars, {d, d}));
    hmm->covariances.clear();
    for (size_t s = 0; s < n; ++s) {
      hmm->covariances.insert(hmm->covariances.end(), covars.values.begin(),
                              covars.values.end());
    }
    return absl::OkStatus();
  }
  if (type == "diag") {
    hmm->covariance_type = CovarianceType::kDiagonal;
  } else if (type == "spherical") {
    hmm->covariance_type = CovarianceType::kSpherical;
  } else {
    return InvalidModel(kCovarianceType, type, "full, diag, spherical or tied");
  }
  if (covars.shape != full) {
    return type == "diag" ? CheckShape(kCovars, covars, {n, d})
                          : CheckShape(kCovars, covars, {n});
  }
  TACTUS_ASSIGN_OR_RETURN(hmm->covariances,
                          Reduced(covars.values, n, d, hmm->covariance_type));
  return absl::OkStatus();
}

absl::StatusOr<GaussianHmm> Convert(const HmmFields& fields) {
  if (fields.means.shape.size() != 2 ||
      fields.means.shape[0] - 1 >= limits::kMaxHmmStates ||
      fields.means.shape[1] - 1 >= limits::kMaxHmmDimensions) {
    return InvalidModel(
        absl::StrCat("shape of ", kMeans),
        absl::StrCat("(", absl::StrJoin(fields.means.shape, ", "), ")"),
        absl::StrCat("(states, dimensions), at most ", limits::kMaxHmmStates,
                     " and ", limits::kMaxHmmDimensions));
  }
  const size_t n = fields.means.shape[0];
  const size_t d = fields.means.shape[1];
  TACTUS_RETURN_IF_ERROR(CheckShape(kStartProb, fields.startprob, {n}));
  TACTUS_RETURN_IF_ERROR(CheckShape(kTransMat, fields.transmat, {n, n}));
  TACTUS_RETURN_IF_ERROR(CheckFinite(kStartProb, fields.startprob));
  TACTUS_RETURN_IF_ERROR(CheckFinite(kTransMat, fields.transmat));
  TACTUS_RETURN_IF_ERROR(CheckFinite(kMeans, fields.means));
  TACTUS_RETURN_IF_ERROR(CheckFinite(kCovars, fields.covars));
  GaussianHmm hmm;
  hmm.states = static_cast<int>(n);
  hmm.dimensions = static_cast<int>(d);
  hmm.start = fields.startprob.values;
  hmm.transition = fields.transmat.values;
  hmm.means = fields.means.values;
  TACTUS_RETURN_IF_ERROR(FillLastRow(n, hmm.transition));
  NormaliseRounded(n, hmm.start);
  NormaliseRounded(n, hmm.transition);
  TACTUS_RETURN_IF_ERROR(TakeCovariances(fields, &hmm));
  TACTUS_RETURN_IF_ERROR(Validate(hmm));
  return hmm;
}

}  // namespace

std::string ElementName(absl::string_view name,
                        const std::vector<size_t>& shape, size_t index) {
  std::string indices;
  for (size_t axis = shape.size(); axis-- > 0;) {
    indices = absl::StrCat("[", index % shape[axis], "]", indices);
    index /= shape[axis];
  }
  return absl::StrCat(name, indices);
}

HmmFields FieldsOf(const GaussianHmm& hmm) {
  const size_t n = hmm.states;
  const size_t d = hmm.dimensions;
  HmmFields fields;
  fields.startprob = {{n}, hmm.start};
  fields.transmat = {{n, n}, hmm.transition};
  fields.means = {{n, d}, hmm.means};
  fields.covars.values = hmm.covariances;
  switch (hmm.covariance_type) {
    case CovarianceType::kFull:
      fields.covariance_type = "full";
      fields.covars.shape = {n, d, d};
      break;
    case CovarianceType::kDiagonal:
      fields.covariance_type = "diag";
      fields.covars.shape = {n, d};
      break;
    case CovarianceType::kSpherical:
      fields.covariance_type = "spherical";
      fields.covars.shape = {n};
      break;
  }
  return fields;
}

absl::StatusOr<GaussianHmm> HmmOf(const HmmFields& fields,
                                  absl::string_view where) {
  absl::StatusOr<GaussianHmm> hmm = Convert(fields);
  if (!hmm.ok()) return Annotate(hmm.status(), where);
  return hmm;
}

}  // namespace tactus::internal
