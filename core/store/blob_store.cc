#include "core/store/blob_store.h"

#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

constexpr char kDrafts[] = "/drafts";

}  // namespace

absl::StatusOr<std::unique_ptr<BlobStore>> BlobStore::Open(FileSystem& files,
                                                           std::string folder) {
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(folder));
  TACTUS_RETURN_IF_ERROR(files.RemoveAll(folder + kDrafts));
  TACTUS_RETURN_IF_ERROR(files.MakeDirectory(folder + kDrafts));
  for (int i = 0; i < 256; ++i) {
    TACTUS_RETURN_IF_ERROR(files.MakeDirectory(
        absl::StrCat(folder, "/", absl::Hex(i, absl::kZeroPad2))));
  }
  TACTUS_RETURN_IF_ERROR(files.SyncDirectory(folder));
  return std::unique_ptr<BlobStore>(new BlobStore(files, std::move(folder)));
}

BlobStore::Batch BlobStore::NewBatch() {
  Batch batch(this);
  batch.prefix_ = absl::StrCat(folder_, kDrafts, "/", batches_++, "-");
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
  return ReadBlobFile(files_, PathOf(sha256), sha256, limit);
}

absl::Status BlobStore::Remove(const std::string& sha256) {
  return files_.Remove(PathOf(sha256));
}

absl::StatusOr<std::vector<std::string>> BlobStore::List() const {
  std::vector<std::string> blobs;
  TACTUS_ASSIGN_OR_RETURN(const auto folders, files_.List(folder_));
  for (const std::string& folder : folders) {
    if (absl::StrCat("/", folder) == kDrafts) continue;
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
  // A damaged blob is written again.
  if (known && store_->Read(sha256, static_cast<int64_t>(bytes.size())).ok()) {
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
