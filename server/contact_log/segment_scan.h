// File: segment_scan.h
//
// ScanSegment: which records a segment of a RecordRing holds, and what is wrong
// with it. It reads the whole file, and changes nothing.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const SegmentScan scan,
//       ScanSegment(PosixFileSystem(), "/data/contacts/0000000000000001", 1,
//                   1 + kSegmentIds));
//   for (const SegmentRecord& record : scan.records) Use(record.id);
//
// Offsets and sizes are in bytes. It holds a mebibyte of the file, or one
// record, in memory. Thread-safe: a free function without state.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/store/file_system.h"

namespace tactus::internal::server {

// No record is larger, whatever a file says.
inline constexpr int64_t kMaxLogRecordBytes = 64L * 1024 * 1024;
// A segment that begins with id n has ids below n + kSegmentIds. What a crash
// of the machine loses has such ids too, so they are not given twice.
inline constexpr uint64_t kSegmentIds = 1024;

// Where a record is.
struct SegmentRecord {
  uint64_t id = 0;
  // Where its frame begins.
  int64_t offset = 0;
  // Its size without the frame's header.
  int64_t bytes = 0;
};

struct SegmentScan {
  // False for a folder, a link and the like.
  bool is_file = false;
  int64_t file_bytes = 0;
  // False if nothing can be read because its header is damaged.
  bool has_header = false;
  // By id. A record is here too if only its own bytes are damaged.
  std::vector<SegmentRecord> records;
  // The id that followed when the ring was closed; none after a crash.
  std::optional<uint64_t> next_id;
  // What is wrong, each a line that names the file and the offset.
  std::vector<std::string> damage;
};

// `first_id` is the one in the file's name; all ids are below `end_id`.
// IO if the file cannot be opened now. Damage is no error.
absl::StatusOr<SegmentScan> ScanSegment(FileSystem& files,
                                        const std::string& path,
                                        uint64_t first_id, uint64_t end_id);

}  // namespace tactus::internal::server
