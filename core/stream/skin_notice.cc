#include "core/stream/skin_notice.h"

namespace tactus::internal {

void WriteSkinNotice(const SkinRange& range, const SkinRangeWatch& watch,
                     v1::StreamNotice* notice) {
  constexpr int kMost = 16;
  notice->set_kind(v1::StreamNotice::KIND_SKIN_DIFFERS);
  notice->set_differing_taxels(watch.differing().size());
  for (const SkinRangeWatch::Reading& reading : watch.differing()) {
    if (notice->taxels_size() == kMost) break;
    v1::TaxelReading* taxel = notice->add_taxels();
    taxel->set_taxel(reading.taxel);
    taxel->set_load(static_cast<double>(reading.load));
    taxel->set_least_trained(static_cast<double>(range.least[reading.taxel]));
    taxel->set_most_trained(static_cast<double>(range.most[reading.taxel]));
  }
}

}  // namespace tactus::internal
