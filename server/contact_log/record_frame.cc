#include "server/contact_log/record_frame.h"

#include <bit>
#include <cstring>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/base/crc32c.h"

namespace tactus::internal::server {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the numbers of segments are little-endian");

constexpr absl::string_view kSegmentMagic = "TACTRING";
constexpr uint32_t kSegmentVersion = 1;
constexpr uint32_t kEndMarkLength = std::numeric_limits<uint32_t>::max();

template <typename Number>
void PutNumber(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

template <typename Number>
Number NumberAt(absl::string_view bytes, size_t offset) {
  Number number;
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

std::string EncodeFrameHeader(uint32_t length, uint64_t id,
                              uint32_t record_crc) {
  std::string fields;
  PutNumber(fields, length);
  PutNumber(fields, id);
  PutNumber(fields, record_crc);
  std::string header;
  PutNumber(header, ExtendCrc32c(0, fields));
  return header + fields;
}

}  // namespace

std::string EncodeSegmentHeader(uint64_t first_id) {
  std::string header(kSegmentMagic);
  PutNumber(header, kSegmentVersion);
  PutNumber(header, first_id);
  PutNumber(header, ExtendCrc32c(0, header));
  return header;
}

std::string SegmentHeaderFault(absl::string_view bytes, uint64_t first_id) {
  if (bytes.size() < kSegmentHeaderBytes) return "ends within its header";
  if (bytes.substr(0, 8) != kSegmentMagic) return "is no segment of a ring";
  if (NumberAt<uint32_t>(bytes, 20) != ExtendCrc32c(0, bytes.substr(0, 20))) {
    return "its header is damaged";
  }
  if (const auto version = NumberAt<uint32_t>(bytes, 8);
      version != kSegmentVersion) {
    return absl::StrCat("has format version ", version,
                        "; this program reads version ", kSegmentVersion);
  }
  if (const auto id = NumberAt<uint64_t>(bytes, 12); id != first_id) {
    return absl::StrCat("begins with id ", id, "; its name says ", first_id);
  }
  return "";
}

std::string EncodeFrame(uint64_t id, absl::string_view record) {
  std::string frame = EncodeFrameHeader(static_cast<uint32_t>(record.size()),
                                        id, ExtendCrc32c(0, record));
  frame.append(record.data(), record.size());
  return frame;
}

std::string EncodeEndMark(uint64_t next_id) {
  return EncodeFrameHeader(kEndMarkLength, next_id, 0);
}

std::optional<FrameHeader> DecodeFrameHeader(absl::string_view bytes) {
  if (bytes.size() < kFrameHeaderBytes) return std::nullopt;
  if (NumberAt<uint32_t>(bytes, 0) != ExtendCrc32c(0, bytes.substr(4, 16))) {
    return std::nullopt;
  }
  const auto length = NumberAt<uint32_t>(bytes, 4);
  FrameHeader header;
  header.id = NumberAt<uint64_t>(bytes, 8);
  header.is_end_mark = length == kEndMarkLength;
  header.record_bytes = header.is_end_mark ? 0 : length;
  header.record_crc = NumberAt<uint32_t>(bytes, 16);
  return header;
}

}  // namespace tactus::internal::server
