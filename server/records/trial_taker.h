// File: trial_taker.h
//
// TrialTaker: takes the bytes of a trial pack in any parts, checks each trial,
// and makes a draft of a blob from it.
//
//   TrialTaker taker(&blobs);
//   TACTUS_RETURN_IF_ERROR(taker.Add(chunk));
//   TACTUS_RETURN_IF_ERROR(taker.End());
//   uint32_t known = 0;
//   return taker.Commit(&known);  // the blobs are on disk
//
// Holds at most one record in memory. Without Commit it leaves no blob. Not
// thread-safe; `blobs` must outlive it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/blob_store.h"
#include "tactus/v1/training.pb.h"

namespace tactus::server {

class TrialTaker {
 public:
  explicit TrialTaker(BlobStore* blobs)
      : blobs_(blobs), batch_(blobs->NewBatch()) {}

  // Takes the next bytes. INVALID_TRIAL if a trial is invalid, empty or too
  // large, or an error of storage. After an error it takes nothing more and
  // returns the same error.
  absl::Status Add(absl::string_view bytes);
  // Call it once, after all bytes. INVALID_TRIAL if they end within a trial or
  // have none.
  absl::Status End();
  // True if the blobs that existed when their trials came exist still.
  absl::StatusOr<bool> BlobsExist() const;
  // Puts all blobs on disk. Counts those that existed before.
  absl::Status Commit(uint32_t* known);

  // Bytes that were taken.
  int64_t size() const { return size_; }
  const std::vector<v1::TrialInfo>& trials() const { return trials_; }

 private:
  absl::Status Take(absl::string_view bytes);
  absl::Status TakeRecord(absl::string_view record);

  BlobStore* const blobs_;
  BlobStore::Batch batch_;
  std::vector<v1::TrialInfo> trials_;
  // The beginning of a record, with its length.
  std::string partial_;
  int64_t size_ = 0;
  absl::Status fault_;
};

}  // namespace tactus::server
