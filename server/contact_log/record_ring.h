// File: record_ring.h
//
// RecordRing: the last records that fit into a number of bytes on disk. A
// record is any bytes; it gets an id, which counts up from 1 and is never given
// twice, also after restarts and crashes.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       auto ring, RecordRing::Open("/data/contacts", int64_t{1} << 30));
//   TACTUS_ASSIGN_OR_RETURN(const uint64_t id, ring->Append(bytes));
//   TACTUS_ASSIGN_OR_RETURN(const std::string record, ring->Read(id));
//
// The folder holds segments: files of at most a sixteenth of the ring, named by
// the first id that they may have. The oldest is removed before a new one could
// make the folder larger than the ring. The folder never exceeds it, also after
// a crash; only one that was opened with a larger size before does so until the
// next Append. At least 14/16 of the ring, less one record, stay in use.
//
// A crash of the process loses nothing that Append returned. A crash of the
// machine loses at most records of the newest segment, and older ones are
// whole: a segment is synced when it is finished. After a crash of either kind
// up to kSegmentIds ids are left out. Open never repairs, cuts or removes a
// file: what it cannot read is reported by damage(), counted in bytes() and
// removed in its turn. Other files in the folder are left alone and not
// counted.
//
// Thread-safety: Append and DropOldest from one thread at a time; all others
// from any thread, at the same time. `files` must outlive it. All sizes are in
// bytes.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/directory_lock.h"
#include "core/store/file_system.h"
#include "server/contact_log/segment_scan.h"

namespace tactus::internal::server {

class RecordRing {
 public:
  // Each segment of the smallest ring has 64 KiB.
  static constexpr int64_t kMinBytes = 1024L * 1024;

  // Makes the folder if its parent exists; reads all segments. INVALID_CONFIG
  // if `max_bytes` is below kMinBytes; IO if a ring has the folder open, here
  // or in another process (DirectoryLock::IsInUse), or a file cannot be opened.
  static absl::StatusOr<std::unique_ptr<RecordRing>> Open(
      const std::string& folder, int64_t max_bytes,
      FileSystem& files = PosixFileSystem());
  // Syncs the newest segment and marks its end.
  ~RecordRing();

  RecordRing(const RecordRing&) = delete;
  RecordRing& operator=(const RecordRing&) = delete;

  // Returns the record's id. MESSAGE_TOO_LARGE if it has more than
  // max_record_bytes(); then nothing changes. STORAGE_FULL or IO if it cannot
  // be written: it is not in the ring, though old records may have been
  // removed for it, and Append works again when the disk does.
  absl::StatusOr<uint64_t> Append(absl::string_view record);

  // Gives the room of the oldest segment back, for a disk that is full. False
  // if none is left. The newest is cut and not removed: its name holds the ids.
  absl::StatusOr<bool> DropOldest();

  // NotFound if no such record is in the ring (any more); DATA_LOST with file
  // and offset if it is damaged.
  absl::StatusOr<std::string> Read(uint64_t id) const;

  // Calls `use` with each record, the oldest first, and `report` with the error
  // of each that is damaged. A record that is removed meanwhile is left out.
  // IO if a file cannot be opened. Neither may call Append or DropOldest.
  absl::Status ForEach(
      absl::FunctionRef<void(uint64_t id, absl::string_view record)> use,
      absl::FunctionRef<void(uint64_t id, const absl::Status& error)> report)
      const;

  // Those of the records in the ring, the oldest first.
  std::vector<uint64_t> Ids() const;
  // That of the oldest record; next_id() if there is none.
  uint64_t first_id() const;
  // Greater than all ids that were ever given; Append gives it or, after an
  // error, a greater one.
  uint64_t next_id() const;
  // What the segments have on disk.
  int64_t bytes() const;
  int64_t max_bytes() const { return max_bytes_; }
  int64_t max_record_bytes() const;

  // What Open found wrong, each a line that names the file and the offset.
  const std::vector<std::string>& damage() const { return damage_; }

 private:
  struct Segment {
    // Its name.
    uint64_t first_id = 0;
    int64_t bytes = 0;
    bool has_header = false;
    std::vector<SegmentRecord> records;
  };
  struct Place {
    std::string path;
    SegmentRecord record;
  };

  RecordRing(FileSystem& files, std::string folder, int64_t max_bytes);

  std::string PathOf(uint64_t first_id) const;
  absl::Status Load();
  // Where a record is; nothing if it is not in the ring.
  std::optional<Place> Find(uint64_t id) const;

  // For the writer.
  bool FitsIntoNewest(int64_t frame_bytes) const;
  absl::Status MakeRoomForSegment();
  absl::Status StartSegment();
  // Forgets what a failed write of a frame has left in the newest segment.
  void CutNewest(int64_t frame_bytes);
  // With the lock: the newest segment stays as a write has left it, so the next
  // one needs another name, also if it has no record.
  void LeaveOutNewestName();
  // With the lock.
  void SetBytes(Segment& segment, int64_t bytes);

  FileSystem& files_;
  const std::string folder_;
  const int64_t max_bytes_;
  const int64_t segment_bytes_;
  std::unique_ptr<DirectoryLock> lock_;
  std::vector<std::string> damage_;
  // The newest segment, if records may be added to it. The writer's.
  std::unique_ptr<AppendableFile> newest_;

  // Held while the members below change, or another thread reads them; the
  // writer reads them without it. No file is read under it.
  mutable std::mutex mutex_;
  // By first_id.
  std::deque<Segment> segments_;
  int64_t bytes_ = 0;
  uint64_t next_id_ = 1;
};

}  // namespace tactus::internal::server
