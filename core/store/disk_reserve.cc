#include "core/store/disk_reserve.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/store/disk_use.h"

namespace tactus::internal {
namespace {

constexpr int64_t kReserveBytes = 32L * 1024 * 1024;
constexpr int64_t kSmallestPart = 16L * 1024;
constexpr int kPartOfDisk = 16;

bool IsFull(const absl::Status& status) {
  return ReasonOf(status) == "STORAGE_FULL";
}

}  // namespace

void DiskReserve::Renew() {
  const std::lock_guard lock(mutex_);
  Take();
}

void DiskReserve::Take() {
  int64_t have = std::clamp(files_.Size(path_).value_or(0), int64_t{0}, bytes_);
  int64_t part = bytes_ - have;
  absl::Status status;
  do {
    // What the file has may have no room yet: a copy of it may have holes.
    status = files_.Reserve(path_, have + part);
    if (status.ok()) {
      have += part;
      part = std::min(part, bytes_ - have);
    } else {
      part /= 2;
    }
  } while (have < bytes_ && part >= kSmallestPart &&
           (status.ok() || IsFull(status)));
  // A file system that cannot reserve room is no full disk.
  full_disk_ = IsFull(status);
}

absl::Status DiskReserve::With(absl::FunctionRef<absl::Status()> work) {
  absl::Status status = work();
  if (!IsFull(status)) return status;
  const std::lock_guard lock(mutex_);
  // Until the end of this, other writers find the disk full.
  full_disk_ = true;
  if (files_.Size(path_).value_or(0) <= 0) return status;
  TACTUS_RETURN_IF_ERROR(files_.Truncate(path_, 0));
  status = work();
  Take();
  return status;
}

absl::Status DiskReserve::Check() {
  const std::lock_guard lock(mutex_);
  if (full_disk_) Take();
  const std::string folder = path_.substr(0, path_.rfind('/'));
  const int64_t free = FreeBytes(folder);
  if (!full_disk_ && (free < 0 || free >= bytes_ / 4)) return absl::OkStatus();
  return StorageFull(
      folder,
      absl::StrCat("the disk is full: what is left is kept for deletions; ",
                   kFullDiskAdvice));
}

int64_t ReserveBytes(const std::string& folder, int64_t catalog_bytes) {
  std::error_code error;
  const auto space = std::filesystem::space(folder, error);
  const int64_t wanted = std::max(kReserveBytes, catalog_bytes);
  if (error) return wanted;
  return std::min(wanted, static_cast<int64_t>(space.capacity) / kPartOfDisk);
}

}  // namespace tactus::internal
