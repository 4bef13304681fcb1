#include "core/store/blob_cache.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

constexpr char kDraftFolder[] = "/drafts";

}  // namespace

absl::StatusOr<std::unique_ptr<BlobCache>> BlobCache::Open(FileSystem& files,
                                                           std::string folder,
                                                           int64_t max_bytes) {
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(folder));
  TACTUS_ASSIGN_OR_RETURN(auto lock, DirectoryLock::Take(folder));
  TACTUS_RETURN_IF_ERROR(files.RemoveAll(folder + kDraftFolder));
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(folder + kDraftFolder));
  std::unique_ptr<BlobCache> cache(
      new BlobCache(files, std::move(folder), max_bytes, std::move(lock)));
  TACTUS_RETURN_IF_ERROR(cache->TakeOver());
  return cache;
}

absl::Status BlobCache::TakeOver() {
  TACTUS_ASSIGN_OR_RETURN(const auto names, files_.List(folder_));
  const std::lock_guard lock(mutex_);
  for (const std::string& name : names) {
    if (!IsSha256Hex(name)) continue;
    const auto size = files_.Size(PathOf(name));
    // The flag may give less room than the last time.
    if (size.ok() && *size >= 0 && MakeRoom(*size)) {
      Add(name, *size);
    } else {
      TACTUS_RETURN_IF_ERROR(files_.Remove(PathOf(name)));
    }
  }
  return absl::OkStatus();
}

std::string BlobCache::PathOf(const std::string& sha256) const {
  return absl::StrCat(folder_, "/", sha256);
}

std::optional<std::string> BlobCache::Find(const std::string& sha256,
                                           int64_t limit) {
  int64_t size = 0;
  {
    const std::lock_guard lock(mutex_);
    const auto copy = copies_.find(sha256);
    if (copy == copies_.end() || copy->second.bytes > limit) {
      ++totals_.missing;
      return std::nullopt;
    }
    size = copy->second.bytes;
    order_.splice(order_.end(), order_, copy->second.place);
  }
  auto bytes = files_.Read(PathOf(sha256), 0, size);
  const bool sound = bytes.ok() && Sha256Hex(*bytes) == sha256;
  const std::lock_guard lock(mutex_);
  if (sound) {
    ++totals_.found;
    return *std::move(bytes);
  }
  ++totals_.missing;
  // Unless it made room for another one meanwhile.
  if (const auto copy = copies_.find(sha256); copy != copies_.end()) {
    ++totals_.damaged;
    Drop(copy);
  }
  return std::nullopt;
}

void BlobCache::Keep(const std::string& sha256, absl::string_view bytes) {
  const auto size = static_cast<int64_t>(bytes.size());
  std::string draft;
  {
    const std::lock_guard lock(mutex_);
    if (copies_.contains(sha256) || !MakeRoom(size)) return;
    draft = absl::StrCat(folder_, kDraftFolder, "/", drafts_++);
  }
  auto file = files_.Append(draft);
  absl::Status status = file.status();
  if (status.ok()) status = (*file)->Append(bytes);
  const std::lock_guard lock(mutex_);
  // Two threads may have read the same blob.
  if (status.ok() && !copies_.contains(sha256)) {
    status = files_.Rename(draft, PathOf(sha256));
    if (status.ok()) return Add(sha256, size);
  }
  if (files_.Remove(draft).ok()) bytes_ -= size;
}

void BlobCache::Remove(const std::string& sha256) {
  const std::lock_guard lock(mutex_);
  const auto copy = copies_.find(sha256);
  if (copy != copies_.end()) Drop(copy);
}

BlobCache::Totals BlobCache::totals() const {
  const std::lock_guard lock(mutex_);
  Totals totals = totals_;
  totals.blobs = static_cast<int64_t>(copies_.size());
  totals.bytes = bytes_;
  return totals;
}

bool BlobCache::MakeRoom(int64_t bytes) {
  if (bytes > max_bytes_) return false;
  while (bytes_ + bytes > max_bytes_) {
    if (order_.empty()) return false;
    Drop(copies_.find(order_.front()));
    ++totals_.evicted;
  }
  bytes_ += bytes;
  return true;
}

void BlobCache::Add(const std::string& sha256, int64_t bytes) {
  copies_[sha256] = {bytes, order_.insert(order_.end(), sha256)};
}

void BlobCache::Drop(std::map<std::string, Copy>::iterator copy) {
  // A file that stays takes its room until the next start.
  if (files_.Remove(PathOf(copy->first)).ok()) bytes_ -= copy->second.bytes;
  order_.erase(copy->second.place);
  copies_.erase(copy);
}

}  // namespace tactus::internal
