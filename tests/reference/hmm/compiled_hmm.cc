#include "tests/reference/hmm/compiled_hmm.h"

#include <cmath>

#include "core/base/status_macros.h"

namespace tactus::internal {

absl::StatusOr<CompiledHmm> CompiledHmm::Create(const GaussianHmm& model) {
  TACTUS_RETURN_IF_ERROR(Validate(model));
  return CompiledHmm(model);
}

CompiledHmm::CompiledHmm(const GaussianHmm& model)
    : emissions_(model), start_(model.start) {
  const int n = model.states;
  for (const double p : start_) log_start_.push_back(std::log(p));
  for (int j = 0; j < n; ++j) {
    int first = n;
    int last = 0;
    for (int i = 0; i < n; ++i) {
      if (model.transition[static_cast<size_t>(i) * n + j] > 0) {
        if (first == n) first = i;
        last = i + 1;
      }
    }
    if (first >= last) first = last = 0;
    ranges_.push_back({first, last, probability_.size()});
    for (int i = first; i < last; ++i) {
      const double p = model.transition[static_cast<size_t>(i) * n + j];
      probability_.push_back(p);
      log_probability_.push_back(std::log(p));
    }
  }
  // Keeps the address of an empty last range valid.
  probability_.push_back(0);
  log_probability_.push_back(0);
}

}  // namespace tactus::internal
