#include "core/train/measure_skin_range.h"

#include <algorithm>
#include <limits>

namespace tactus::internal {

SkinRange MeasureSkinRange(
    const std::vector<const LabelledContact*>& contacts) {
  const auto taxels = static_cast<size_t>(contacts.front()->layout.taxels());
  SkinRange range;
  range.least.assign(taxels, std::numeric_limits<float>::max());
  range.most.assign(taxels, 0);
  ContactLoads loads(taxels);
  for (const LabelledContact* contact : contacts) {
    loads.Reset();
    for (size_t t = 0; t < contact->frames.size(); ++t) {
      if (contact->frames.touched(t)) loads.Step(contact->frames.loads(t));
    }
    if (loads.frames() == 0) continue;
    for (size_t i = 0; i < taxels; ++i) {
      range.least[i] = std::min(range.least[i], loads.Mean(i));
      range.most[i] = std::max(range.most[i], loads.Mean(i));
    }
  }
  return range;
}

}  // namespace tactus::internal
