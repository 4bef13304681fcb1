#include "core/base/crc32c.h"

#include <isa-l/crc.h>

namespace tactus::internal {
namespace {

// The library counts bytes in an int.
constexpr size_t kMaxBytes = 1 << 30;

}  // namespace

uint32_t ExtendCrc32c(uint32_t crc, absl::string_view bytes) {
  // The library takes and returns the register, which is the complement.
  uint32_t state = ~crc;
  while (!bytes.empty()) {
    const absl::string_view part = bytes.substr(0, kMaxBytes);
    state = crc32_iscsi(
        // The library's parameter lacks const.
        reinterpret_cast<unsigned char*>(const_cast<char*>(part.data())),
        static_cast<int>(part.size()), state);
    bytes.remove_prefix(part.size());
  }
  return ~state;
}

}  // namespace tactus::internal
