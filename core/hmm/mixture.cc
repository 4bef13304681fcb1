#include "core/hmm/mixture.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal {

absl::Status Validate(const HmmMixture& mixture) {
  const size_t count = mixture.components.size();
  if (count < 1 || count > static_cast<size_t>(limits::kMaxHmmsPerClass)) {
    return InvalidModel("components", count,
                        absl::StrCat("1 to ", limits::kMaxHmmsPerClass));
  }
  if (mixture.log_weight.size() != count) {
    return InvalidModel("log_weight size", mixture.log_weight.size(),
                        absl::StrCat(count, ", one per component"));
  }
  double sum = 0;
  for (size_t k = 0; k < count; ++k) {
    const double w = mixture.log_weight[k];
    if (!std::isfinite(w) || w > 1e-9) {
      return InvalidModel(absl::StrCat("log_weight[", k, "]"), w,
                          "finite and at most 0");
    }
    sum += std::exp(w);
    TACTUS_RETURN_IF_ERROR(Validate(mixture.components[k]));
    if (mixture.components[k].dimensions != mixture.components[0].dimensions) {
      return InvalidModel(absl::StrCat("components[", k, "] dimensions"),
                          mixture.components[k].dimensions,
                          "the same for all components");
    }
  }
  if (std::abs(sum - 1) > 1e-9) {
    return InvalidModel("log_weight sum of exponentials", sum, "1");
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal
