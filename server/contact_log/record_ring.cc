#include "server/contact_log/record_ring.h"

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/crc32c.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "server/contact_log/record_frame.h"

namespace tactus::internal::server {
namespace {

constexpr int64_t kSegmentsOfRing = 16;
constexpr size_t kSegmentNameDigits = 16;
// Files with greater names are none of the ring: it makes none.
constexpr uint64_t kMaxFirstId = 1'000'000'000'000'000;

// The first id that a segment's name says; nothing for other names.
std::optional<uint64_t> FirstIdOf(absl::string_view name) {
  uint64_t id = 0;
  if (name.size() != kSegmentNameDigits ||
      !std::ranges::all_of(name, absl::ascii_isdigit) ||
      !absl::SimpleAtoi(name, &id) || id == 0 || id > kMaxFirstId) {
    return std::nullopt;
  }
  return id;
}

// The folder that holds `path`.
std::string ParentOf(const std::string& path) {
  const size_t end = path.find_last_not_of('/');
  const size_t slash = path.find_last_of('/', end);
  if (slash == path.npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

// The record in `frame`, which was read from where the index says it is.
absl::StatusOr<std::string> RecordOf(std::string frame, const std::string& path,
                                     const SegmentRecord& place) {
  const auto header = DecodeFrameHeader(frame);
  if (!header || header->is_end_mark || header->id != place.id ||
      header->record_bytes != place.bytes ||
      ExtendCrc32c(0, absl::string_view(frame).substr(kFrameHeaderBytes)) !=
          header->record_crc) {
    return DataLost(path, absl::StrCat("at byte ", place.offset, ": record ",
                                       place.id, " is damaged"));
  }
  frame.erase(0, kFrameHeaderBytes);
  return frame;
}

}  // namespace

RecordRing::RecordRing(FileSystem& files, std::string folder, int64_t max_bytes)
    : files_(files),
      folder_(std::move(folder)),
      max_bytes_(max_bytes),
      segment_bytes_(max_bytes / kSegmentsOfRing) {}

absl::StatusOr<std::unique_ptr<RecordRing>> RecordRing::Open(
    const std::string& folder, int64_t max_bytes, FileSystem& files) {
  if (max_bytes < kMinBytes) {
    return InvalidConfig("the size of a ring of records", max_bytes,
                         absl::StrCat("at least ", kMinBytes, " bytes"));
  }
  std::unique_ptr<RecordRing> ring(new RecordRing(files, folder, max_bytes));
  TACTUS_ASSIGN_OR_RETURN(const int64_t folder_bytes, files.Size(folder));
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(folder));
  if (folder_bytes < 0) {
    TACTUS_RETURN_IF_ERROR(files.SyncDirectory(ParentOf(folder)));
  }
  TACTUS_ASSIGN_OR_RETURN(ring->lock_, DirectoryLock::Take(folder));
  TACTUS_RETURN_IF_ERROR(ring->Load());
  return ring;
}

absl::Status RecordRing::Load() {
  TACTUS_ASSIGN_OR_RETURN(const auto names, files_.List(folder_));
  std::vector<uint64_t> first_ids;
  for (const std::string& name : names) {
    if (const auto id = FirstIdOf(name)) first_ids.push_back(*id);
  }
  std::ranges::sort(first_ids);
  for (size_t i = 0; i < first_ids.size(); ++i) {
    const uint64_t first_id = first_ids[i];
    uint64_t end_id = first_id + kSegmentIds;
    if (i + 1 < first_ids.size()) end_id = std::min(end_id, first_ids[i + 1]);
    TACTUS_ASSIGN_OR_RETURN(
        SegmentScan scan,
        ScanSegment(files_, PathOf(first_id), first_id, end_id));
    damage_.insert(damage_.end(), scan.damage.begin(), scan.damage.end());
    // Its name is taken in any case.
    next_id_ = std::max(scan.next_id.value_or(end_id), first_id + 1);
    if (!scan.is_file) continue;
    bytes_ += scan.file_bytes;
    segments_.push_back(
        {first_id, scan.file_bytes, scan.has_header, std::move(scan.records)});
  }
  return absl::OkStatus();
}

RecordRing::~RecordRing() {
  if (newest_ == nullptr) return;
  // Without the mark the next ring leaves ids out; nothing else depends on it.
  newest_->Append(EncodeEndMark(next_id_)).IgnoreError();
  newest_->Sync().IgnoreError();
}

std::string RecordRing::PathOf(uint64_t first_id) const {
  return absl::StrCat(folder_, "/", absl::Dec(first_id, absl::kZeroPad16));
}

int64_t RecordRing::max_record_bytes() const {
  // A frame and an end mark.
  return std::min(segment_bytes_ - kSegmentHeaderBytes - 2 * kFrameHeaderBytes,
                  kMaxLogRecordBytes);
}

bool RecordRing::FitsIntoNewest(int64_t frame_bytes) const {
  const Segment& newest = segments_.back();
  return newest.bytes + frame_bytes + kFrameHeaderBytes <= segment_bytes_ &&
         next_id_ < newest.first_id + kSegmentIds;
}

absl::StatusOr<uint64_t> RecordRing::Append(absl::string_view record) {
  if (static_cast<int64_t>(record.size()) > max_record_bytes()) {
    return InvalidValue(v1::ERROR_REASON_MESSAGE_TOO_LARGE,
                        "the size of a record", record.size(),
                        absl::StrCat("at most ", max_record_bytes(),
                                     " bytes in a ring of ", max_bytes_));
  }
  const int64_t frame_bytes =
      kFrameHeaderBytes + static_cast<int64_t>(record.size());
  if (newest_ != nullptr && !FitsIntoNewest(frame_bytes)) {
    const absl::Status finished = newest_->Sync();
    newest_ = nullptr;
    TACTUS_RETURN_IF_ERROR(finished);
  }
  if (newest_ == nullptr) TACTUS_RETURN_IF_ERROR(StartSegment());
  const uint64_t id = next_id_;
  const absl::Status written = newest_->Append(EncodeFrame(id, record));
  if (!written.ok()) {
    CutNewest(frame_bytes);
    return written;
  }
  const std::lock_guard guard(mutex_);
  Segment& newest = segments_.back();
  newest.records.push_back(
      {id, newest.bytes, static_cast<int64_t>(record.size())});
  SetBytes(newest, newest.bytes + frame_bytes);
  next_id_ = id + 1;
  return id;
}

// The room of the whole segment, so that it can grow without a removal that
// the directory's sync does not cover.
absl::Status RecordRing::MakeRoomForSegment() {
  while (bytes_ + segment_bytes_ > max_bytes_) {
    TACTUS_ASSIGN_OR_RETURN(const bool dropped, DropOldest());
    if (!dropped) return StorageFull(folder_, "no segment can be removed");
  }
  return absl::OkStatus();
}

absl::Status RecordRing::StartSegment() {
  if (next_id_ > kMaxFirstId) {
    return StorageFull(folder_, "its ids are used up; use another folder");
  }
  TACTUS_RETURN_IF_ERROR(MakeRoomForSegment());
  const std::string path = PathOf(next_id_);
  const auto create = [&]() -> absl::StatusOr<std::unique_ptr<AppendableFile>> {
    TACTUS_ASSIGN_OR_RETURN(auto file, files_.Append(path));
    TACTUS_RETURN_IF_ERROR(file->Append(EncodeSegmentHeader(next_id_)));
    // Its name holds the ids: after a crash of the machine none is given twice,
    // whatever is left of its bytes.
    TACTUS_RETURN_IF_ERROR(files_.SyncDirectory(folder_));
    return file;
  };
  auto file = create();
  if (file.ok()) {
    const std::lock_guard guard(mutex_);
    segments_.push_back({next_id_, 0, true, {}});
    SetBytes(segments_.back(), kSegmentHeaderBytes);
    newest_ = *std::move(file);
    return absl::OkStatus();
  }
  files_.Remove(path).IgnoreError();
  const auto left = files_.Size(path);
  if (left.ok() && *left < 0) return file.status();
  const std::lock_guard guard(mutex_);
  segments_.push_back({next_id_, 0, false, {}});
  SetBytes(segments_.back(), left.value_or(kSegmentHeaderBytes));
  LeaveOutNewestName();
  return file.status();
}

void RecordRing::CutNewest(int64_t frame_bytes) {
  Segment& newest = segments_.back();
  const std::string path = PathOf(newest.first_id);
  if (files_.Truncate(path, newest.bytes).ok()) return;
  // The next record goes to another segment, so this one is finished.
  newest_->Sync().IgnoreError();
  newest_ = nullptr;
  const int64_t left = files_.Size(path).value_or(newest.bytes + frame_bytes);
  const std::lock_guard guard(mutex_);
  SetBytes(newest, std::max(left, newest.bytes));
  LeaveOutNewestName();
}

void RecordRing::LeaveOutNewestName() {
  next_id_ = std::max(next_id_, segments_.back().first_id + 1);
}

void RecordRing::SetBytes(Segment& segment, int64_t bytes) {
  bytes_ += bytes - segment.bytes;
  segment.bytes = bytes;
}

absl::StatusOr<bool> RecordRing::DropOldest() {
  if (segments_.empty()) return false;
  // A reader that fails meanwhile looks into the index once more, and must find
  // there whether the record is gone.
  const std::lock_guard guard(mutex_);
  Segment& oldest = segments_.front();
  if (segments_.size() > 1) {
    TACTUS_RETURN_IF_ERROR(files_.Remove(PathOf(oldest.first_id)));
    SetBytes(oldest, 0);
    segments_.pop_front();
    return true;
  }
  const int64_t kept = oldest.has_header ? kSegmentHeaderBytes : 0;
  if (oldest.bytes <= kept) return false;
  TACTUS_RETURN_IF_ERROR(files_.Truncate(PathOf(oldest.first_id), kept));
  oldest.records.clear();
  SetBytes(oldest, kept);
  return true;
}

std::optional<RecordRing::Place> RecordRing::Find(uint64_t id) const {
  const std::lock_guard guard(mutex_);
  const auto behind =
      std::ranges::upper_bound(segments_, id, {}, &Segment::first_id);
  if (behind == segments_.begin()) return std::nullopt;
  const Segment& segment = *std::prev(behind);
  const auto found =
      std::ranges::lower_bound(segment.records, id, {}, &SegmentRecord::id);
  if (found == segment.records.end() || found->id != id) return std::nullopt;
  return Place{PathOf(segment.first_id), *found};
}

absl::StatusOr<std::string> RecordRing::Read(uint64_t id) const {
  const std::optional<Place> place = Find(id);
  absl::StatusOr<std::string> record;
  if (place) {
    const auto& [path, at] = *place;
    record = files_.Read(path, at.offset, kFrameHeaderBytes + at.bytes);
    if (absl::IsDataLoss(record.status())) {
      record = Annotate(record.status(),
                        absl::StrCat("record ", id, " at byte ", at.offset));
    } else if (record.ok()) {
      record = RecordOf(*std::move(record), path, at);
    }
    // An error of a record that was removed meanwhile has no meaning.
    if (record.ok() || Find(id)) return record;
  }
  return absl::NotFoundError(
      absl::StrCat("record ", id, " is not in the ring ", folder_,
                   "; its oldest is ", first_id(), ", its next ", next_id()));
}

absl::Status RecordRing::ForEach(
    absl::FunctionRef<void(uint64_t id, absl::string_view record)> use,
    absl::FunctionRef<void(uint64_t id, const absl::Status& error)> report)
    const {
  for (const uint64_t id : Ids()) {
    const auto record = Read(id);
    if (record.ok()) {
      use(id, *record);
    } else if (absl::IsDataLoss(record.status())) {
      report(id, record.status());
    } else if (!absl::IsNotFound(record.status())) {
      return record.status();
    }
  }
  return absl::OkStatus();
}

std::vector<uint64_t> RecordRing::Ids() const {
  const std::lock_guard guard(mutex_);
  std::vector<uint64_t> ids;
  for (const Segment& segment : segments_) {
    for (const SegmentRecord& record : segment.records) {
      ids.push_back(record.id);
    }
  }
  return ids;
}

uint64_t RecordRing::first_id() const {
  const std::lock_guard guard(mutex_);
  for (const Segment& segment : segments_) {
    if (!segment.records.empty()) return segment.records.front().id;
  }
  return next_id_;
}

uint64_t RecordRing::next_id() const {
  const std::lock_guard guard(mutex_);
  return next_id_;
}

int64_t RecordRing::bytes() const {
  const std::lock_guard guard(mutex_);
  return bytes_;
}

}  // namespace tactus::internal::server
