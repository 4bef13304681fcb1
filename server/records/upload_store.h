// File: upload_store.h
//
// UploadStore: bytes that arrive in chunks, survive crashes, and become a
// version of a dataset.
//
//   auto upload = uploads.Create("datasets/grasps", request_id, false, caller);
//   {
//     TACTUS_ASSIGN_OR_RETURN(auto writer,
//                             uploads.Write(upload->name(), caller));
//     TACTUS_RETURN_IF_ERROR(writer->Append(offset, chunk, crc32c));
//     TACTUS_RETURN_IF_ERROR(writer->Commit());  // now on disk
//   }
//   uint32_t known = 0;
//   auto version = uploads.Finish(upload->name(), size, crc32c, caller,
//   &known);
//
// Bytes behind the committed size are cut off when the next writer begins.
// Trials are checked, and their blobs drafted, while they arrive. What a
// restart or another upload made of that is lost; Finish then reads the trials
// from the upload's file.
//
// Errors: INVALID_NAME, UPLOAD_NOT_FOUND, and those of storage. Thread-safe; a
// writer belongs to one thread. What it is given must outlive it.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/base/limits_training.h"
#include "core/store/data_directory.h"
#include "server/records/caller.h"
#include "server/records/dataset_store.h"
#include "server/records/trial_taker.h"
#include "tactus/v1/storage.pb.h"
#include "tactus/v1/training.pb.h"

namespace tactus::internal::server {

class UploadStore {
 public:
  // Holds an upload for one call. What was appended and not committed is lost.
  class Writer {
   public:
    ~Writer();
    // OFFSET_MISMATCH, CHECKSUM_MISMATCH, STORAGE_FULL. After an error of
    // storage the upload goes on with another writer.
    absl::Status Append(int64_t offset, absl::string_view chunk,
                        uint32_t crc32c);
    // Makes all that was appended durable. QUOTA_EXCEEDED if it does not fit
    // into the quota of the client that made the upload: all that was appended
    // since the last Commit is then lost.
    absl::Status Commit();
    int64_t committed_size() const { return upload_.committed_size(); }
    // Bytes that were appended since the last Commit.
    int64_t uncommitted() const { return size_ - upload_.committed_size(); }

   private:
    friend class UploadStore;
    Writer(UploadStore* store, std::unique_ptr<Lock> lock)
        : store_(store), lock_(std::move(lock)) {}

    UploadStore* const store_;
    const std::unique_ptr<Lock> lock_;
    v1::StoredUpload upload_;
    std::unique_ptr<AppendableFile> file_;
    // Checks the trials while they arrive; null if bytes are missing.
    std::unique_ptr<TrialTaker> taker_;
    int64_t size_ = 0;
    uint32_t crc32c_ = 0;
    // The error of storage after which nobody knows what the file holds behind
    // the committed size.
    absl::Status fault_;
  };

  UploadStore(DataDirectory* data, DatasetStore* datasets, NowMs now,
              const Quotas& quotas = {})
      : data_(data),
        datasets_(datasets),
        now_(std::move(now)),
        quotas_(quotas) {}

  // The upload of an earlier request of this caller with this id, or a new one.
  // An empty id always makes a new one. QUOTA_EXCEEDED if no byte would fit.
  absl::StatusOr<v1::StoredUpload> Create(absl::string_view dataset,
                                          absl::string_view request_id,
                                          bool replace, const Caller& caller,
                                          bool replace_labels = false);
  absl::StatusOr<v1::StoredUpload> Get(absl::string_view name) const;
  // The same for its owner. PERMISSION_DENIED for others than the client that
  // made it and admins, as from Write and Finish.
  absl::StatusOr<v1::StoredUpload> GetOwn(absl::string_view name,
                                          const Caller& caller) const;
  // UPLOAD_BUSY while another writer, or Finish, holds the upload.
  absl::StatusOr<std::unique_ptr<Writer>> Write(absl::string_view name,
                                                const Caller& caller);

  // Checks all trials and makes them a version of the dataset; returns that
  // version if it was done before. INVALID_TRIAL names the trial and the field.
  // `known` receives the number of trials that were stored already, `notes` (if
  // not null) what became of those that are not stored as they came.
  absl::StatusOr<v1::DatasetVersion> Finish(
      absl::string_view name, int64_t size, uint32_t crc32c,
      const Caller& caller, uint32_t* known,
      std::vector<v1::TrialNote>* notes = nullptr);

  // Removes uploads that nobody wrote to for limits::kAbandonedUploadMs, and
  // files of uploads that do not exist. Returns the number of uploads that were
  // removed.
  absl::StatusOr<int> RemoveAbandoned();

 private:
  friend class Writer;
  // Takes the upload for one caller; UPLOAD_BUSY.
  absl::StatusOr<std::unique_ptr<Lock>> Hold(const std::string& id);
  absl::Status Save(const Lock& lock, const v1::StoredUpload& upload);
  // Copies the upload of a dead server into a new file, because that server may
  // still write to the old one.
  absl::Status Copy(const Lock& lock, v1::StoredUpload& upload);
  absl::Status RemoveStrayFiles();
  // One that takes a pack from its beginning. `known`: as TrialTaker::Sources.
  std::unique_ptr<TrialTaker> NewTaker(const std::string& file,
                                       MemoryBudget* known);
  // The trials of an upload's first `size` bytes as they arrived; null if they
  // must be read from its file.
  std::unique_ptr<TrialTaker> TakeTaker(const std::string& file, int64_t size);
  // Keeps it until the next call, or a few others, have come.
  void KeepTaker(const std::string& file, std::unique_ptr<TrialTaker> taker);
  // The trials of the whole pack, checked, and not yet blobs.
  absl::StatusOr<std::unique_ptr<TrialTaker>> CheckTrials(
      const std::string& file, int64_t size);
  // The content of the version that the upload becomes, beside the `held`
  // trials of the one before. Makes a blob of each trial.
  absl::StatusOr<DatasetStore::Content> StoreTrials(
      const v1::StoredUpload& upload, std::vector<v1::TrialInfo> held,
      uint32_t* known, std::vector<v1::TrialNote>* notes);
  absl::StatusOr<std::unique_ptr<TrialTaker>> ReadTrials(
      const std::string& file, int64_t size);

  DataDirectory* const data_;
  DatasetStore* const datasets_;
  const NowMs now_;
  const Quotas quotas_;
  MemoryBudget parsing_{limits::kMaxParsingBytes};
  MemoryBudget known_{limits::kMaxKnownTrialBytes};
  std::mutex mutex_;
  // Takers of uploads that nobody holds; the one kept last is at the end.
  std::deque<std::pair<std::string, std::unique_ptr<TrialTaker>>> takers_;
};

}  // namespace tactus::internal::server
