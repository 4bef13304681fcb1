#include "server/contact_log/recording_bytes.h"

#include <zlib.h>

#include "core/base/errors.h"
#include "core/base/limits_contact_log.h"

namespace tactus::internal::server {
namespace {

// Fast: the skin's noise is most of a recording, and does not shrink.
constexpr int kLevel = 3;
constexpr char kWhat[] = "a recording of the contact log";

Bytef* BytesOf(std::string& text) {
  return reinterpret_cast<Bytef*>(text.data());
}
const Bytef* BytesOf(const std::string& text) {
  return reinterpret_cast<const Bytef*>(text.data());
}

}  // namespace

std::string Deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string deflated(size, '\0');
  // The room suffices, so it can fail only without memory.
  compress2(BytesOf(deflated), &size, BytesOf(bytes), bytes.size(), kLevel);
  deflated.resize(size);
  return deflated;
}

absl::StatusOr<std::string> Inflated(const std::string& deflated, size_t size) {
  constexpr size_t kMost =
      limits::kMaxRecordingChunks * limits::kRecordingChunkBytes;
  if (size > kMost) return DataLost(kWhat, "is larger than any");
  std::string bytes(size, '\0');
  uLongf length = size;
  const int result =
      uncompress(BytesOf(bytes), &length, BytesOf(deflated), deflated.size());
  if (result != Z_OK || length != size) {
    return DataLost(kWhat, "cannot be inflated");
  }
  return bytes;
}

}  // namespace tactus::internal::server
