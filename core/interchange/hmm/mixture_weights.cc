#include "core/interchange/hmm/mixture_weights.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"

namespace tactus::internal {

std::vector<double> WeightsOf(const HmmMixture& mixture) {
  std::vector<double> weights;
  for (const double log_weight : mixture.log_weight) {
    weights.push_back(std::exp(log_weight));
  }
  return weights;
}

absl::Status SetWeights(const std::vector<double>& weights,
                        absl::string_view where, HmmMixture* mixture) {
  const size_t count = mixture->components.size();
  if (!weights.empty() && weights.size() != count) {
    return InvalidModel(absl::StrCat(where, " weights"), weights.size(),
                        absl::StrCat(count, ", one per HMM"));
  }
  mixture->log_weight.assign(count, -std::log(static_cast<double>(count)));
  for (size_t k = 0; k < weights.size(); ++k) {
    mixture->log_weight[k] = std::log(weights[k]);
  }
  return Annotate(Validate(*mixture), where);
}

}  // namespace tactus::internal
