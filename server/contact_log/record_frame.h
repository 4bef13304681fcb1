// File: record_frame.h
//
// The bytes of a segment of a RecordRing: a header, then one frame for each
// record, and an end mark if the ring was closed. All numbers are
// little-endian.
//
//   std::string segment = EncodeSegmentHeader(first_id);
//   segment += EncodeFrame(first_id, record);
//   segment += EncodeEndMark(first_id + 1);
//
// The header of a segment: 8 bytes "TACTRING"; 4, the version of the format, 1;
// 8, the first id that a record of it may have; 4, the CRC32C of the bytes
// before. A frame: 4, the CRC32C of the 16 bytes that follow; 4, the length of
// the record, 2^32 - 1 in an end mark; 8, the record's id, in an end mark the
// next id; 4, the CRC32C of the record; the record.
//
// A frame's header has its own checksum, so damage of one record does not hide
// those behind it. Sizes are in bytes. Any bytes may be decoded. Thread-safe:
// free functions without state.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "absl/strings/string_view.h"

namespace tactus::internal::server {

inline constexpr int64_t kSegmentHeaderBytes = 24;
inline constexpr int64_t kFrameHeaderBytes = 20;

std::string EncodeSegmentHeader(uint64_t first_id);

// Says why `bytes` is not the header of a segment that begins with `first_id`;
// empty if it is.
std::string SegmentHeaderFault(absl::string_view bytes, uint64_t first_id);

// `record` must have less than 2^32 - 1 bytes.
std::string EncodeFrame(uint64_t id, absl::string_view record);
std::string EncodeEndMark(uint64_t next_id);

struct FrameHeader {
  // The record's, or the next one in an end mark.
  uint64_t id = 0;
  bool is_end_mark = false;
  // The record's; 0 and without meaning in an end mark.
  int64_t record_bytes = 0;
  uint32_t record_crc = 0;
};

// Reads the first kFrameHeaderBytes of `bytes`. Nothing if there are fewer, or
// their checksum is wrong.
std::optional<FrameHeader> DecodeFrameHeader(absl::string_view bytes);

}  // namespace tactus::internal::server
