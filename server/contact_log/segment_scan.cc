#include "server/contact_log/segment_scan.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/crc32c.h"
#include "core/base/status_macros.h"
#include "server/contact_log/record_frame.h"

namespace tactus::internal::server {
namespace {

constexpr int64_t kWindowBytes = 1024L * 1024;

// Reads a file from its beginning to its end, in large parts.
class FileWindow {
 public:
  FileWindow(FileSystem& files, const std::string& path, int64_t file_bytes)
      : files_(files), path_(path), file_bytes_(file_bytes) {}

  // `size` bytes from `offset` on, until the next call; fewer at the end of the
  // file.
  absl::StatusOr<absl::string_view> At(int64_t offset, int64_t size) {
    size = std::min(size, file_bytes_ - offset);
    const auto held = static_cast<int64_t>(window_.size());
    if (offset < begin_ || offset + size > begin_ + held) {
      window_.clear();
      const int64_t wanted =
          std::min(std::max(size, kWindowBytes), file_bytes_ - offset);
      TACTUS_ASSIGN_OR_RETURN(window_, files_.Read(path_, offset, wanted));
      begin_ = offset;
    }
    return absl::string_view(window_).substr(
        static_cast<size_t>(offset - begin_), static_cast<size_t>(size));
  }

 private:
  FileSystem& files_;
  const std::string& path_;
  const int64_t file_bytes_;
  std::string window_;
  int64_t begin_ = 0;
};

class SegmentScanner {
 public:
  SegmentScanner(FileSystem& files, const std::string& path, uint64_t first_id,
                 uint64_t end_id, int64_t file_bytes)
      : path_(path),
        window_(files, path, file_bytes),
        first_id_(first_id),
        end_id_(end_id) {
    scan_.is_file = true;
    scan_.file_bytes = file_bytes;
  }

  absl::StatusOr<SegmentScan> Scan() && {
    const absl::Status status = ReadAll();
    // The disk cannot read it, or it became shorter.
    if (absl::IsDataLoss(status)) {
      scan_.damage.emplace_back(status.message());
    } else if (!status.ok()) {
      return status;
    }
    return std::move(scan_);
  }

 private:
  absl::Status ReadAll() {
    TACTUS_ASSIGN_OR_RETURN(const absl::string_view header,
                            window_.At(0, kSegmentHeaderBytes));
    const std::string fault = SegmentHeaderFault(header, first_id_);
    if (!fault.empty()) {
      Report(0, absl::StrCat(fault, "; the file is kept and not read"));
      return absl::OkStatus();
    }
    scan_.has_header = true;
    offset_ = kSegmentHeaderBytes;
    while (offset_ < scan_.file_bytes && !scan_.next_id) {
      TACTUS_ASSIGN_OR_RETURN(const bool more, ReadFrame());
      if (!more) return absl::OkStatus();
    }
    if (offset_ < scan_.file_bytes) Report(offset_, "bytes follow its end");
    return absl::OkStatus();
  }

  // False if nothing behind it can be found.
  absl::StatusOr<bool> ReadFrame() {
    TACTUS_ASSIGN_OR_RETURN(const absl::string_view bytes,
                            window_.At(offset_, kFrameHeaderBytes));
    if (static_cast<int64_t>(bytes.size()) < kFrameHeaderBytes) {
      return EndsWithin();
    }
    const auto header = DecodeFrameHeader(bytes);
    const uint64_t least =
        scan_.records.empty() ? first_id_ : scan_.records.back().id + 1;
    // An id out of order is that of an older file whose blocks a crash shows.
    if (!header || header->id < least ||
        header->id >= end_id_ + (header->is_end_mark ? 1 : 0) ||
        header->record_bytes > kMaxLogRecordBytes) {
      Report(offset_, "no record begins here; what follows is not read");
      return false;
    }
    if (header->is_end_mark) {
      scan_.next_id = header->id;
      offset_ += kFrameHeaderBytes;
      return true;
    }
    const int64_t end = offset_ + kFrameHeaderBytes + header->record_bytes;
    if (end > scan_.file_bytes) return EndsWithin();
    TACTUS_ASSIGN_OR_RETURN(
        const absl::string_view record,
        window_.At(offset_ + kFrameHeaderBytes, header->record_bytes));
    if (ExtendCrc32c(0, record) != header->record_crc) {
      Report(offset_, absl::StrCat("record ", header->id, " is damaged"));
    }
    scan_.records.push_back({header->id, offset_, header->record_bytes});
    offset_ = end;
    return true;
  }

  bool EndsWithin() {
    Report(offset_,
           "ends within the record that begins here: the server or "
           "the machine stopped while it was written");
    return false;
  }

  void Report(int64_t offset, absl::string_view fault) {
    scan_.damage.push_back(
        absl::StrCat(path_, ": at byte ", offset, ": ", fault));
  }

  const std::string& path_;
  FileWindow window_;
  const uint64_t first_id_;
  const uint64_t end_id_;
  int64_t offset_ = 0;
  SegmentScan scan_;
};

}  // namespace

absl::StatusOr<SegmentScan> ScanSegment(FileSystem& files,
                                        const std::string& path,
                                        uint64_t first_id, uint64_t end_id) {
  // It is opened, as no other file than a regular one can be.
  const absl::Status opened = files.Read(path, 0, 0).status();
  if (absl::IsDataLoss(opened)) {
    SegmentScan scan;
    scan.damage.emplace_back(opened.message());
    return scan;
  }
  TACTUS_RETURN_IF_ERROR(opened);
  TACTUS_ASSIGN_OR_RETURN(const int64_t file_bytes, files.Size(path));
  return SegmentScanner(files, path, first_id, end_id,
                        std::max<int64_t>(file_bytes, 0))
      .Scan();
}

}  // namespace tactus::internal::server
