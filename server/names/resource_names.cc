#include "server/names/resource_names.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"

namespace tactus::internal::server {
namespace {

constexpr absl::string_view kVersions = "/versions/";
constexpr size_t kMaxId = 64;
constexpr uint64_t kMaxNumber = 2'000'000'000;

bool IsNumbered(absl::string_view collection) {
  return collection == "uploads" || collection == "operations";
}

bool HasVersions(absl::string_view collection) {
  return collection == "datasets" || collection == "models";
}

// Without sign, space or leading zero, so that each number has one name.
// SimpleAtoi alone takes spaces and line ends.
bool ParseNumber(absl::string_view text, uint64_t& number) {
  return !text.empty() && text[0] != '0' &&
         std::all_of(text.begin(), text.end(), absl::ascii_isdigit) &&
         absl::SimpleAtoi(text, &number) && number <= kMaxNumber;
}

std::string Wanted(absl::string_view collection) {
  if (IsNumbered(collection)) return absl::StrCat(collection, "/NUMBER");
  return absl::StrCat(
      collection, "/ID",
      HasVersions(collection) ? " or with /versions/NUMBER" : "",
      ", where ID is 1 to 64 of a-z, 0-9 and -");
}

}  // namespace

std::string ResourceName::Parent() const {
  return absl::StrCat(collection, "/", id);
}

std::string ResourceName::ToString() const {
  if (version == 0) return Parent();
  return absl::StrCat(Parent(), kVersions, version);
}

bool IsResourceId(absl::string_view id) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
  };
  return !id.empty() && id.size() <= kMaxId &&
         std::all_of(id.begin(), id.end(), allowed);
}

absl::StatusOr<ResourceName> ParseName(absl::string_view name,
                                       absl::string_view collection) {
  const absl::Status wrong = InvalidName(name, Wanted(collection));
  absl::string_view rest = name;
  if (!absl::ConsumePrefix(&rest, collection) ||
      !absl::ConsumePrefix(&rest, "/")) {
    return wrong;
  }
  ResourceName parsed;
  parsed.collection = std::string(collection);
  const size_t split = rest.find(kVersions);
  if (split != absl::string_view::npos && HasVersions(collection)) {
    uint64_t version = 0;
    if (!ParseNumber(rest.substr(split + kVersions.size()), version)) {
      return wrong;
    }
    parsed.version = static_cast<uint32_t>(version);
    rest = rest.substr(0, split);
  }
  uint64_t number = 0;
  if (IsNumbered(collection) ? !ParseNumber(rest, number)
                             : !IsResourceId(rest)) {
    return wrong;
  }
  parsed.id = std::string(rest);
  return parsed;
}

absl::StatusOr<ResourceName> ParseVersionName(absl::string_view name,
                                              absl::string_view collection) {
  auto parsed = ParseName(name, collection);
  if (parsed.ok() && parsed->version == 0) {
    return InvalidName(name, absl::StrCat(collection, "/ID/versions/NUMBER"));
  }
  return parsed;
}

std::string CatalogKey(const ResourceName& name) {
  uint64_t number = 0;
  if (IsNumbered(name.collection) && absl::SimpleAtoi(name.id, &number)) {
    return NumberKey(number);
  }
  if (name.version == 0) return name.id;
  return absl::StrCat(name.id, "/", NumberKey(name.version));
}

}  // namespace tactus::internal::server
