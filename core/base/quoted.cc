#include "core/base/quoted.h"

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "core/base/limits.h"

namespace tactus {

std::string Quoted(absl::string_view text) {
  const absl::string_view shown = text.substr(0, limits::kMaxNameBytes);
  return absl::StrCat("\"", absl::CHexEscape(shown), "\"",
                      shown.size() < text.size() ? "..." : "");
}

bool IsPrintable(absl::string_view text) {
  for (size_t i = 0; i < text.size(); ++i) {
    if (absl::ascii_iscntrl(text[i])) return false;
    // C1 controls are U+0080 to U+009F: C2 80 to C2 9F.
    if (text[i] == '\xc2' && i + 1 < text.size() &&
        static_cast<unsigned char>(text[i + 1]) <= 0x9f) {
      return false;
    }
  }
  return true;
}

}  // namespace tactus
