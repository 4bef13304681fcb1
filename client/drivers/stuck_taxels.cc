#include "client/drivers/stuck_taxels.h"

#include <algorithm>

namespace tactus::internal::client {

void StuckTaxels::Add(std::span<const float> loads) {
  loads_.resize(loads.size(), 0);
  runs_.resize(loads.size(), 0);
  for (size_t i = 0; i < loads.size(); ++i) {
    runs_[i] = loads[i] == loads_[i] ? std::min(runs_[i] + 1, frames_) : 1;
    loads_[i] = loads[i];
  }
}

std::vector<int> StuckTaxels::Taxels() const {
  std::vector<int> stuck;
  for (size_t i = 0; i < runs_.size(); ++i) {
    if (loads_[i] > 0 && runs_[i] >= frames_) {
      stuck.push_back(static_cast<int>(i));
    }
  }
  return stuck;
}

}  // namespace tactus::internal::client
