// File: hmm_fields.h
//
// One HMM under the names that hmmlearn's GaussianHMM gives its arrays.
//
//   const HmmFields fields = FieldsOf(hmm);
//   fields.means.shape;  // {states, dimensions}
//   TACTUS_ASSIGN_OR_RETURN(GaussianHmm back, HmmOf(fields, "class HU"));
//
// Thread-safe: free functions without state.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/hmm/gaussian_hmm.h"

namespace tactus::internal {

// Row-major.
struct NumberArray {
  std::vector<size_t> shape;
  std::vector<double> values;
};

// "means_[0][2]": element `index` of an array with this shape.
std::string ElementName(absl::string_view name,
                        const std::vector<size_t>& shape, size_t index);

inline constexpr char kCovarianceType[] = "covariance_type";
inline constexpr char kStartProb[] = "startprob_";
inline constexpr char kTransMat[] = "transmat_";
inline constexpr char kMeans[] = "means_";
inline constexpr char kCovars[] = "covars_";
// Mixtures of Gaussians in a state (hmmlearn's GMMHMM), which are refused.
inline constexpr char kMixtureWeights[] = "weights_";

// N states, D dimensions.
struct HmmFields {
  // "full", "diag", "spherical" or "tied".
  std::string covariance_type;
  NumberArray startprob;  // N
  NumberArray transmat;   // N x N
  NumberArray means;      // N x D
  // full N x D x D, diag N x D, spherical N, tied D x D. hmmlearn's getter
  // gives N x D x D for every type, and that is read as well.
  NumberArray covars;
};

// In the shapes that hmmlearn's setters take.
HmmFields FieldsOf(const GaussianHmm& hmm);

// INVALID_MODEL, with `where` and the field's name first, unless shapes and
// values are right. Probabilities whose sum is off by up to 1e-6, as float
// arrays and rounded text have it, are divided by their sum. A last row of
// zeros in `transmat`, as hmmlearn leaves it for a last state that training
// never saw left, is read as a state that stays; any other row of zeros is
// refused.
absl::StatusOr<GaussianHmm> HmmOf(const HmmFields& fields,
                                  absl::string_view where);

}  // namespace tactus::internal
