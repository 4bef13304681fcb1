#include "core/store/blob_store.h"

#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/limits_catalog.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

constexpr char kDrafts[] = "/drafts";
constexpr char kRemoved[] = "/removed";

}  // namespace

absl::StatusOr<std::unique_ptr<BlobStore>> BlobStore::Open(FileSystem& files,
                                                           std::string folder) {
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(folder));
  TACTUS_RETURN_IF_ERROR(files.RemoveAll(folder + kDrafts));
  return OpenAs(files, std::move(folder), "");
}

absl::StatusOr<std::unique_ptr<BlobStore>> BlobStore::OpenShared(
    FileSystem& files, std::string folder, absl::string_view name) {
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(folder));
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(folder + kRemoved));
  return OpenAs(files, std::move(folder), std::string(name));
}

absl::StatusOr<std::unique_ptr<BlobStore>> BlobStore::OpenAs(FileSystem& files,
                                                             std::string folder,
                                                             std::string name) {
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(folder + kDrafts));
  if (!name.empty()) {
    TACTUS_RETURN_IF_ERROR(
        files.MakeDirectory(absl::StrCat(folder, kDrafts, "/", name)));
  }
  for (int i = 0; i < 256; ++i) {
    TACTUS_RETURN_IF_ERROR(files.MakeDirectory(
        absl::StrCat(folder, "/", absl::Hex(i, absl::kZeroPad2))));
  }
  TACTUS_RETURN_IF_ERROR(files.SyncDirectory(folder));
  return std::unique_ptr<BlobStore>(
      new BlobStore(files, std::move(folder), std::move(name)));
}

BlobStore::Batch BlobStore::NewBatch() {
  Batch batch(this);
  batch.prefix_ = absl::StrCat(folder_, kDrafts, "/", name_,
                               name_.empty() ? "" : "/", batches_++, "-");
  return batch;
}

std::string BlobPath(absl::string_view folder, absl::string_view sha256) {
  return absl::StrCat(folder, "/", sha256.substr(0, 2), "/", sha256);
}

std::string BlobStore::PathOf(absl::string_view sha256) const {
  return BlobPath(folder_, sha256);
}

absl::StatusOr<bool> BlobStore::Has(const std::string& sha256) const {
  TACTUS_ASSIGN_OR_RETURN(const int64_t size, files_.Size(PathOf(sha256)));
  return size >= 0;
}

absl::StatusOr<std::string> BlobStore::Read(const std::string& sha256,
                                            int64_t limit) const {
  if (cache_ == nullptr) {
    return ReadBlobFile(files_, PathOf(sha256), sha256, limit);
  }
  if (auto copy = cache_->Find(sha256, limit)) return *std::move(copy);
  TACTUS_ASSIGN_OR_RETURN(std::string bytes,
                          ReadBlobFile(files_, PathOf(sha256), sha256, limit));
  cache_->Keep(sha256, bytes);
  return bytes;
}

absl::Status BlobStore::Remove(const std::string& sha256) {
  if (cache_ != nullptr) cache_->Remove(sha256);
  if (name_.empty()) return files_.Remove(PathOf(sha256));
  TACTUS_ASSIGN_OR_RETURN(const bool exists, Has(sha256));
  if (!exists) return absl::OkStatus();
  return files_.Rename(PathOf(sha256),
                       absl::StrCat(folder_, kRemoved, "/", sha256));
}

absl::Status BlobStore::Sweep(
    int64_t now_ms, absl::FunctionRef<bool(const std::string& name)> is_alive,
    absl::FunctionRef<absl::StatusOr<bool>(const std::string& sha256)>
        is_used) {
  if (name_.empty()) return absl::OkStatus();
  TACTUS_ASSIGN_OR_RETURN(const auto drafts, files_.List(folder_ + kDrafts));
  for (const std::string& name : drafts) {
    if (is_alive(name)) continue;
    TACTUS_RETURN_IF_ERROR(
        files_.RemoveAll(absl::StrCat(folder_, kDrafts, "/", name)));
  }
  TACTUS_ASSIGN_OR_RETURN(const auto removed, files_.List(folder_ + kRemoved));
  std::map<std::string, int64_t> since;
  for (const std::string& sha256 : removed) {
    const std::string path = absl::StrCat(folder_, kRemoved, "/", sha256);
    TACTUS_ASSIGN_OR_RETURN(const bool used, is_used(sha256));
    TACTUS_ASSIGN_OR_RETURN(const bool again, Has(sha256));
    if (used && !again) {
      TACTUS_RETURN_IF_ERROR(files_.Rename(path, PathOf(sha256)));
      continue;
    }
    const auto known = removed_since_.find(sha256);
    const int64_t first =
        known == removed_since_.end() ? now_ms : known->second;
    if (now_ms - first >= limits::kRemovedBlobMs) {
      TACTUS_RETURN_IF_ERROR(files_.Remove(path));
    } else {
      since[sha256] = first;
    }
  }
  removed_since_ = std::move(since);
  return absl::OkStatus();
}

absl::StatusOr<std::vector<std::string>> BlobStore::List() const {
  std::vector<std::string> blobs;
  TACTUS_ASSIGN_OR_RETURN(const auto folders, files_.List(folder_));
  for (const std::string& folder : folders) {
    const std::string place = absl::StrCat("/", folder);
    if (place == kDrafts || place == kRemoved) continue;
    TACTUS_ASSIGN_OR_RETURN(const auto names,
                            files_.List(absl::StrCat(folder_, "/", folder)));
    for (const std::string& name : names) {
      if (IsSha256Hex(name)) blobs.push_back(name);
    }
  }
  return blobs;
}

BlobStore::Batch::~Batch() {
  if (store_ == nullptr) return;
  // What cannot be removed now is removed by the next Open.
  for (const std::string& sha256 : drafts_) {
    store_->files_.Remove(prefix_ + sha256).IgnoreError();
  }
}

absl::StatusOr<std::string> BlobStore::Batch::Add(absl::string_view bytes) {
  std::string sha256 = Sha256Hex(bytes);
  used_ = true;
  if (drafts_.contains(sha256)) return sha256;
  TACTUS_ASSIGN_OR_RETURN(const bool known, store_->Has(sha256));
  // A damaged blob is written again, also if the cache has a sound copy.
  if (known && ReadBlobFile(store_->files_, store_->PathOf(sha256), sha256,
                            static_cast<int64_t>(bytes.size()))
                   .ok()) {
    return sha256;
  }
  drafts_.insert(sha256);
  TACTUS_ASSIGN_OR_RETURN(const auto file,
                          store_->files_.Append(prefix_ + sha256));
  TACTUS_RETURN_IF_ERROR(file->Append(bytes));
  return sha256;
}

absl::Status BlobStore::Batch::Commit() {
  FileSystem& files = store_->files_;
  if (!drafts_.empty()) {
    TACTUS_RETURN_IF_ERROR(files.SyncAll(store_->folder_));
    for (const std::string& sha256 : drafts_) {
      TACTUS_RETURN_IF_ERROR(
          files.Rename(prefix_ + sha256, store_->PathOf(sha256)));
    }
  }
  if (used_) TACTUS_RETURN_IF_ERROR(files.SyncAll(store_->folder_));
  store_ = nullptr;
  return absl::OkStatus();
}

absl::StatusOr<std::string> ReadBlobFile(FileSystem& files,
                                         const std::string& path,
                                         absl::string_view sha256,
                                         int64_t limit) {
  auto bytes = ReadWhole(files, path, limit);
  absl::Status status = bytes.status();
  if (status.ok() && Sha256Hex(*bytes) != sha256) {
    status = DataLost(path, "the bytes do not have the SHA-256 of its name");
  }
  if (status.ok()) return bytes;
  if (!absl::IsDataLoss(status)) return status;
  return DataLost(
      path, absl::StrCat(absl::StripPrefix(status.message(), path + ": "),
                         ". Restore this file from a back-up, or delete the "
                         "dataset or model that needs it"));
}

}  // namespace tactus::internal
