// File: trial_taker.h
//
// TrialTaker: takes the bytes of a trial pack in any parts, checks each trial,
// and makes a draft of a blob from it.
//
//   TrialTaker taker({.blobs = &blobs, .parsing = &parsing, .read = read});
//   TACTUS_RETURN_IF_ERROR(taker.Add(chunk));
//   TACTUS_RETURN_IF_ERROR(taker.End());
//   uint32_t known = 0;
//   return taker.Commit(&known);  // the blobs are on disk
//
// Between two calls of Add it holds no bytes of the pack, only what is known of
// the trials so far. Without Commit it leaves no blob. Not thread-safe; what it
// is given must outlive it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/data/trial_pack.h"
#include "core/store/blob_store.h"
#include "server/records/memory_budget.h"
#include "tactus/v1/training.pb.h"

namespace tactus::internal::server {

class TrialTaker {
 public:
  struct Sources {
    BlobStore* blobs = nullptr;
    // Memory for trials that are parsed.
    MemoryBudget* parsing = nullptr;
    // Memory for what is known of trials; null: for as many as a version has.
    MemoryBudget* known = nullptr;
    // Returns bytes of the pack that were added, also those of the present call
    // of Add.
    std::function<absl::StatusOr<std::string>(int64_t offset, int64_t size)>
        read = {};
  };

  explicit TrialTaker(Sources sources)
      : sources_(std::move(sources)), batch_(sources_.blobs->NewBatch()) {}
  ~TrialTaker();

  TrialTaker(const TrialTaker&) = delete;
  TrialTaker& operator=(const TrialTaker&) = delete;

  // Takes the next bytes. INVALID_TRIAL if a trial is invalid, empty or too
  // large, or has fields that are not known; CANCELLED if there is no memory in
  // `known`; or an error of storage. After an error it takes nothing more and
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
  // Takes the record of `size` bytes that begins at `offset` of the pack.
  // `bytes`: the record, or empty if it is to be read.
  absl::Status TakeRecord(int64_t offset, int64_t size,
                          absl::string_view bytes);
  absl::Status Store(absl::string_view record);
  // Begins a trial: INVALID_TRIAL, CANCELLED.
  absl::Status CheckRoom(uint32_t length);

  const Sources sources_;
  BlobStore::Batch batch_;
  std::vector<v1::TrialInfo> trials_;
  PackSplitter splitter_;
  // Trials whose memory was taken from `known`.
  int64_t known_ = 0;
  int64_t size_ = 0;
  absl::Status fault_;
};

}  // namespace tactus::internal::server
