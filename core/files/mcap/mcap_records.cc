#include "core/files/mcap/mcap_records.h"

#include <zlib.h>

namespace tactus::internal {

uint32_t McapCrc(uint32_t crc, absl::string_view bytes) {
  return static_cast<uint32_t>(
      crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace tactus::internal
