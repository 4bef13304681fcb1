#include "server/contact_log/contact_name.h"

#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"

namespace tactus::internal::server {
namespace {

constexpr char kPrefix[] = "contacts/";

}  // namespace

std::string ContactName::ToString() const {
  if (place == 0) return absl::StrCat(kPrefix, record);
  return absl::StrCat(kPrefix, record, "-", place + 1);
}

absl::StatusOr<ContactName> ParseContactName(absl::string_view text) {
  ContactName name;
  absl::string_view rest = text;
  const bool has_prefix = absl::ConsumePrefix(&rest, kPrefix);
  const std::pair<absl::string_view, absl::string_view> parts =
      absl::StrSplit(rest, absl::MaxSplits('-', 1));
  if (has_prefix && absl::SimpleAtoi(parts.first, &name.record) &&
      (parts.second.empty() || absl::SimpleAtoi(parts.second, &name.place))) {
    if (name.place > 0) --name.place;
    // Each contact has one name.
    if (name.ToString() == text) return name;
  }
  return InvalidName(text, "contacts/C, as trainctl contacts list shows it");
}

}  // namespace tactus::internal::server
