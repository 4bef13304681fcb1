#include "client/drivers/stuck_taxels.h"

#include <algorithm>

namespace tactus::internal::client {

void StuckTaxels::Add(std::span<const uint16_t> taxels) {
  values_.resize(taxels.size(), 0);
  runs_.resize(taxels.size(), 0);
  for (size_t i = 0; i < taxels.size(); ++i) {
    runs_[i] = taxels[i] == values_[i] ? std::min(runs_[i] + 1, frames_) : 1;
    values_[i] = taxels[i];
  }
}

std::vector<int> StuckTaxels::Taxels() const {
  std::vector<int> stuck;
  for (size_t i = 0; i < runs_.size(); ++i) {
    if (values_[i] > 0 && runs_[i] >= frames_) {
      stuck.push_back(static_cast<int>(i));
    }
  }
  return stuck;
}

}  // namespace tactus::internal::client
