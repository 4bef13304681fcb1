#include "client/training/trial_uploader.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/crc32c.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

// True if the same bytes may be sent again: the call broke, or bytes were lost
// or damaged on their way.
bool MayWriteAgain(const absl::Status& status) {
  const std::string reason = ReasonOf(status);
  return MayRetry(status) || reason == "OFFSET_MISMATCH" ||
         reason == "CHECKSUM_MISMATCH";
}

}  // namespace

TrialUploader::TrialUploader(TrainingClient* client, UploadOptions options)
    : client_(client), options_(std::move(options)) {}

absl::StatusOr<v1::FinishUploadResponse> TrialUploader::Upload(
    const v1::CreateUploadRequest& request, const NextTrial& next_trial) {
  TACTUS_ASSIGN_OR_RETURN(const v1::CreateUploadResponse created,
                          client_->CreateUpload(request));
  upload_ = created.upload();
  committed_ = created.committed_size();
  unconfirmed_.clear();

  // The waits of two clients differ as their requests do.
  Retries retries(options_.retry, ExtendCrc32c(0, request.request_id()));
  TrialPacker packer(next_trial, {.chunk_bytes = options_.chunk_bytes,
                                  .ahead_bytes = options_.ahead_bytes});
  while (!packer.ended() || !unconfirmed_.empty()) {
    const int64_t before = committed_;
    absl::Status status = WriteOnce(packer);
    while (!status.ok()) {
      TACTUS_RETURN_IF_ERROR(retries.WaitIf(MayWriteAgain(status), status));
      status = AskCommitted();
    }
    if (committed_ > before) retries.Reset();
    Report(packer, committed_);
  }

  if (committed_ != packer.size()) {
    return InvalidResponse(
        absl::StrCat("committed_size of ", upload_), committed_,
        absl::StrCat(packer.size(), ", the size of all trials"));
  }
  v1::FinishUploadRequest finish;
  finish.set_upload(upload_);
  finish.set_size(packer.size());
  finish.set_crc32c(packer.crc32c());
  retries.Reset();
  for (;;) {
    auto finished = client_->FinishUpload(finish);
    if (finished.ok()) return finished;
    TACTUS_RETURN_IF_ERROR(retries.Wait(finished.status()));
  }
}

absl::Status TrialUploader::WriteOnce(TrialPacker& packer) {
  const auto timeout = client_->long_timeout();
  const auto context = client_->NewContext(timeout);
  v1::WriteUploadResponse response;
  std::unique_ptr<grpc::ClientWriter<v1::WriteUploadRequest>> writer;
  v1::WriteUploadRequest request;
  request.set_upload(upload_);
  const auto write = [&](const PackChunk& chunk) {
    if (writer == nullptr) {
      writer = client_->training().WriteUpload(context.get(), &response);
    }
    request.set_write_offset(chunk.offset);
    request.set_data(chunk.data);
    request.set_crc32c(ExtendCrc32c(0, chunk.data));
    const bool written = writer->Write(request);
    request.clear_upload();
    return written;
  };

  int64_t sent = committed_;
  bool open = true;
  for (const PackChunk& chunk : unconfirmed_) {
    open = open && write(chunk);
    sent = chunk.offset + static_cast<int64_t>(chunk.data.size());
  }
  while (open && !packer.ended() &&
         sent - committed_ < static_cast<int64_t>(options_.call_bytes)) {
    auto chunk = packer.Next();
    if (!chunk.ok()) {
      context->TryCancel();
      if (writer != nullptr) writer->Finish();
      return chunk.status();
    }
    if (chunk->data.empty()) break;
    const int64_t end =
        chunk->offset + static_cast<int64_t>(chunk->data.size());
    // The server has it from an earlier program.
    if (end <= committed_) continue;
    if (chunk->offset < committed_) {
      chunk->data.erase(0, committed_ - chunk->offset);
      chunk->offset = committed_;
    }
    unconfirmed_.push_back(*std::move(chunk));
    open = write(unconfirmed_.back());
    sent = end;
    Report(packer, sent);
  }
  if (writer == nullptr) return absl::OkStatus();
  writer->WritesDone();
  if (const grpc::Status status = writer->Finish(); !status.ok()) {
    return TrainingClient::ErrorOf(status, "WriteUpload", timeout);
  }
  if (response.committed_size() != sent) {
    return InvalidResponse("committed_size", response.committed_size(),
                           absl::StrCat(sent, ", as all of it was sent"));
  }
  return TakeCommitted(sent);
}

absl::Status TrialUploader::AskCommitted() {
  TACTUS_ASSIGN_OR_RETURN(const v1::QueryWriteStatusResponse status,
                          client_->QueryWriteStatus(upload_));
  return TakeCommitted(status.committed_size());
}

absl::Status TrialUploader::TakeCommitted(int64_t committed) {
  if (committed < committed_) {
    return InvalidResponse(
        "committed_size", committed,
        absl::StrCat("at least ", committed_, ", as it was before"));
  }
  committed_ = committed;
  while (!unconfirmed_.empty()) {
    PackChunk& first = unconfirmed_.front();
    const int64_t end = first.offset + static_cast<int64_t>(first.data.size());
    if (end <= committed) {
      unconfirmed_.pop_front();
      continue;
    }
    if (first.offset < committed) {
      first.data.erase(0, committed - first.offset);
      first.offset = committed;
    }
    break;
  }
  return absl::OkStatus();
}

void TrialUploader::Report(const TrialPacker& packer, int64_t bytes) const {
  if (options_.on_progress) options_.on_progress(bytes, packer.trials());
}

}  // namespace tactus::internal::client
