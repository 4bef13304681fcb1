// File: trial_uploader.h
//
// TrialUploader: sends trials to a dataset, which gets a new version.
//
//   v1::CreateUploadRequest request;
//   request.set_dataset("datasets/arm");
//   request.set_request_id("arm-1");
//   TrialUploader uploader(&client, {});
//   size_t next = 0;
//   TACTUS_ASSIGN_OR_RETURN(
//       const v1::FinishUploadResponse made,
//       uploader.Upload(request,
//                       [&]() -> absl::StatusOr<std::optional<Trial>> {
//                         if (next == reader.size()) return std::nullopt;
//                         return reader.Read(next++);
//                       }));
//
// If a call breaks, the uploader asks the server how many bytes it has and
// continues there, after a wait that grows. If the program ends, a second
// program that gives the same request_id and the same trials continues too: it
// packs again what the server has, but does not send it.
//
// Trials are read ahead while others are sent. Memory: the bytes of one call
// and those read ahead (UploadOptions), and one trial.
// Not thread-safe; the client must outlive it.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/training/retry.h"
#include "client/training/training_client.h"
#include "client/training/trial_packer.h"

namespace tactus::internal::client {

struct UploadOptions {
  // Data of one message; the server accepts at most 1 MiB.
  size_t chunk_bytes = 1024 * 1024;
  // Data of one WriteUpload call. The server confirms it at the end of the
  // call; until then the uploader keeps it.
  size_t call_bytes = 32 * 1024 * 1024;
  // Data that is read ahead while other data is sent or confirmed.
  size_t ahead_bytes = 16 * 1024 * 1024;
  RetryOptions retry = {};
  // Called after each chunk and each call with the bytes that were sent or are
  // confirmed, and the number of trials that were packed.
  std::function<void(int64_t bytes, uint64_t trials)> on_progress = {};
};

class TrialUploader {
 public:
  TrialUploader(TrainingClient* client, UploadOptions options);

  // Calls `next_trial` on another thread, never twice at once. Each trial needs
  // an id. INVALID_RESPONSE if the server confirms bytes that it cannot have;
  // else the server's error, or that of `next_trial`.
  absl::StatusOr<v1::FinishUploadResponse> Upload(
      const v1::CreateUploadRequest& request, const NextTrial& next_trial);

 private:
  // Sends chunks in one call. On success all of them are confirmed.
  absl::Status WriteOnce(TrialPacker& packer);
  // Asks how many bytes the server has, and forgets them.
  absl::Status AskCommitted();
  // The server has `committed` bytes. They may be more than this uploader has
  // sent, if the call of an earlier program still went on.
  absl::Status TakeCommitted(int64_t committed);
  void Report(const TrialPacker& packer, int64_t bytes) const;

  TrainingClient* const client_;
  const UploadOptions options_;

  std::string upload_;
  // Bytes of the pack that the server has.
  int64_t committed_ = 0;
  // Sent, but not confirmed: from `committed_` on, without gaps.
  std::deque<PackChunk> unconfirmed_;
};

}  // namespace tactus::internal::client
