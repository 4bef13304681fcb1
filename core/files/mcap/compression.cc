#include "core/files/mcap/compression.h"

#include <lz4frame.h>
#include <zstd.h>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/text.h"

namespace tactus::internal {
namespace {

bool FromZstd(absl::string_view bytes, std::string* out) {
  const size_t size =
      ZSTD_decompress(out->data(), out->size(), bytes.data(), bytes.size());
  return ZSTD_isError(size) == 0 && size == out->size();
}

bool FromLz4(absl::string_view bytes, std::string* out) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION))) {
    return false;
  }
  size_t read = 0;
  size_t written = 0;
  size_t hint = 1;
  // 0 is the end of a frame.
  while (hint != 0) {
    size_t in = bytes.size() - read;
    size_t made = out->size() - written;
    hint = LZ4F_decompress(context, out->data() + written, &made,
                           bytes.data() + read, &in, nullptr);
    if (LZ4F_isError(hint) || (in == 0 && made == 0)) break;
    read += in;
    written += made;
  }
  LZ4F_freeDecompressionContext(context);
  return hint == 0 && written == out->size() && read == bytes.size();
}

}  // namespace

std::string Decompress(absl::string_view compression, absl::string_view bytes,
                       uint64_t size, std::string* out) {
  const bool zstd = compression == "zstd";
  if (!zstd && compression != "lz4") {
    return absl::StrCat("is compressed with ", Quoted(compression),
                        "; zstd and lz4 are read");
  }
  out->resize(size);
  if (zstd ? FromZstd(bytes, out) : FromLz4(bytes, out)) return "";
  return absl::StrCat("is compressed with ", compression,
                      ", and it is damaged or not the stated ", size, " bytes");
}

bool IsZstd(absl::string_view bytes) {
  return absl::StartsWith(bytes, "\x28\xb5\x2f\xfd");
}

uint64_t ZstdSize(absl::string_view bytes) {
  const unsigned long long size =
      ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR) {
    return 0;
  }
  return size;
}

}  // namespace tactus::internal
