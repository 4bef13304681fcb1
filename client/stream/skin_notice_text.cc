#include "client/stream/skin_notice_text.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace tactus::internal::client {

std::string SkinNoticeText(const v1::StreamNotice& notice) {
  constexpr int kShown = 3;
  std::string text = absl::StrCat(
      notice.differing_taxels(),
      notice.differing_taxels() == 1 ? " taxel reads" : " taxels read",
      " unlike any recording of training, in several contacts: ");
  for (int i = 0; i < notice.taxels_size() && i < kShown; ++i) {
    const v1::TaxelReading& taxel = notice.taxels(i);
    absl::StrAppendFormat(&text, "%staxel %u %.3g (%.3g to %.3g in training)",
                          i == 0 ? "" : ", ", taxel.taxel(), taxel.load(),
                          taxel.least_trained(), taxel.most_trained());
  }
  if (static_cast<int>(notice.differing_taxels()) > kShown) text += ", ...";
  return text;
}

}  // namespace tactus::internal::client
