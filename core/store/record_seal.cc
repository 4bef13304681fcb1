#include "core/store/record_seal.h"

#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/crc32c.h"
#include "core/base/errors.h"
#include "core/base/text.h"

namespace tactus::internal {
namespace {

std::string SealOf(Table table, absl::string_view key,
                   absl::string_view value) {
  RecordSeal crc = ExtendCrc32c(0, absl::StrCat(static_cast<int>(table), "/"));
  crc = ExtendCrc32c(ExtendCrc32c(crc, key), value);
  std::string seal(sizeof crc, '\0');
  std::memcpy(seal.data(), &crc, sizeof crc);
  return seal;
}

}  // namespace

std::string SealRecord(Table table, absl::string_view key,
                       absl::string_view value) {
  return absl::StrCat(value, SealOf(table, key, value));
}

absl::StatusOr<std::string> UnsealRecord(Table table, absl::string_view key,
                                         std::string sealed) {
  if (sealed.size() >= sizeof(RecordSeal)) {
    const std::string seal = sealed.substr(sealed.size() - sizeof(RecordSeal));
    sealed.resize(sealed.size() - sizeof(RecordSeal));
    if (seal == SealOf(table, key, sealed)) return sealed;
  }
  return DataLost(Quoted(key), "the record does not have its CRC32C");
}

std::string EndOfPrefix(std::string prefix) {
  while (!prefix.empty() && static_cast<unsigned char>(prefix.back()) == 0xff) {
    prefix.pop_back();
  }
  if (!prefix.empty()) ++prefix.back();
  return prefix;
}

}  // namespace tactus::internal
