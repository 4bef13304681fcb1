// File: blob_store.h
//
// BlobStore: immutable bytes on disk, named by their SHA-256. The same bytes
// are stored once.
//
//   TACTUS_ASSIGN_OR_RETURN(auto blobs, BlobStore::Open(files, "blobs"));
//   BlobStore::Batch batch = blobs->NewBatch();
//   TACTUS_ASSIGN_OR_RETURN(std::string sha256, batch.Add(record));
//   TACTUS_RETURN_IF_ERROR(batch.Commit());  // now on disk
//
// A blob becomes visible in one step, complete, on disk before its name. Drafts
// that a crash left are removed by Open.
//
// Thread-safe, except that a Batch belongs to one thread. `files` must outlive
// the store, and the store its batches.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/blob_cache.h"
#include "core/store/file_system.h"

namespace tactus::internal {

class BlobStore {
 public:
  // Blobs that become durable together, which is much faster than one by one.
  class Batch {
   public:
    Batch(Batch&&) = default;
    // Removes the drafts that Commit did not rename.
    ~Batch();

    // Writes `bytes` as a draft unless the blob exists undamaged. Returns its
    // SHA-256, 64 hexadecimal digits.
    absl::StatusOr<std::string> Add(absl::string_view bytes);
    // Makes all of them durable and visible, those that existed before too:
    // their names may not be on disk yet. Call it once.
    absl::Status Commit();
    // Number of blobs that did not exist before, or were damaged.
    size_t added() const { return drafts_.size(); }
    // True if the blob did not exist when it was added.
    bool HasDraft(const std::string& sha256) const {
      return drafts_.contains(sha256);
    }

   private:
    friend class BlobStore;
    explicit Batch(BlobStore* store) : store_(store) {}

    BlobStore* store_;
    // SHA-256 of each blob that has a draft.
    std::set<std::string> drafts_;
    // True if Add was called.
    bool used_ = false;
    std::string prefix_;
  };

  // Creates the directory if it does not exist.
  static absl::StatusOr<std::unique_ptr<BlobStore>> Open(FileSystem& files,
                                                         std::string folder);
  // A directory that several processes share; `name` is unique among them, and
  // a file name. What is removed there lies in "removed" for a while, because a
  // process that was taken for dead may still remove what another one wants.
  static absl::StatusOr<std::unique_ptr<BlobStore>> OpenShared(
      FileSystem& files, std::string folder, absl::string_view name);

  Batch NewBatch();

  absl::StatusOr<bool> Has(const std::string& sha256) const;
  // Reads of whole blobs use it from now on. Call it before other threads use
  // the store.
  void UseCache(std::unique_ptr<BlobCache> cache) { cache_ = std::move(cache); }
  // Null without one.
  const BlobCache* cache() const { return cache_.get(); }
  // DATA_LOST if the blob does not exist or its bytes do not have this SHA-256;
  // a copy in the cache is as good as the blob.
  absl::StatusOr<std::string> Read(const std::string& sha256,
                                   int64_t limit) const;
  // Removes a blob; OK if it does not exist.
  absl::Status Remove(const std::string& sha256);
  // In a shared directory: deletes the drafts of processes that are not alive,
  // puts back what was removed and is used, and deletes what has lain there for
  // limits::kRemovedBlobMs, as this process has seen it. For one thread.
  absl::Status Sweep(
      int64_t now_ms, absl::FunctionRef<bool(const std::string& name)> is_alive,
      absl::FunctionRef<absl::StatusOr<bool>(const std::string& sha256)>
          is_used);
  // The SHA-256 of all blobs, sorted.
  absl::StatusOr<std::vector<std::string>> List() const;

  // The file of a blob, for a process that reads blobs itself.
  std::string PathOf(absl::string_view sha256) const;

 private:
  BlobStore(FileSystem& files, std::string folder, std::string name)
      : files_(files), folder_(std::move(folder)), name_(std::move(name)) {}
  static absl::StatusOr<std::unique_ptr<BlobStore>> OpenAs(FileSystem& files,
                                                           std::string folder,
                                                           std::string name);

  FileSystem& files_;
  const std::string folder_;
  // This process among those that share the directory; empty: it is alone.
  const std::string name_;
  std::unique_ptr<BlobCache> cache_;
  std::atomic<uint64_t> batches_ = 0;
  // When Sweep saw it first.
  std::map<std::string, int64_t> removed_since_;
};

// The file of a blob in the store in `folder`.
std::string BlobPath(absl::string_view folder, absl::string_view sha256);

// Reads a blob from the file of BlobPath.
absl::StatusOr<std::string> ReadBlobFile(FileSystem& files,
                                         const std::string& path,
                                         absl::string_view sha256,
                                         int64_t limit);

}  // namespace tactus::internal
