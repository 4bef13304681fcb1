#include <string>
#include <utility>
#include <vector>

#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "server/rpc/control_handlers.h"
#include "server/rpc/training_rpcs.h"
#include "tactus/v1/training.pb.h"

namespace tactus::internal::server {
namespace {

constexpr char kUploadService[] = "/tactus.v1.TrainingService/";
// Bytes of an upload between two commits.
constexpr int64_t kCommitBytes = 64L * 1024 * 1024;

absl::Status WriteUpload(TrainingBackend& backend, ControlStream& stream) {
  v1::WriteUploadRequest request;
  bool more = false;
  TACTUS_RETURN_IF_ERROR(ReadMessage(stream, &request, &more));
  if (!more) return EmptyRequest();
  const std::string name = request.upload();
  TACTUS_ASSIGN_OR_RETURN(const auto writer,
                          backend.uploads().Write(name, stream.caller()));
  while (more) {
    if (!request.upload().empty() && request.upload() != name) {
      return InvalidName(request.upload(), "the name in the first message");
    }
    // The next chunk comes while this one is checked and written.
    stream.StartRead();
    const absl::Status status = writer->Append(
        request.write_offset(), request.data(), request.crc32c());
    if (!status.ok()) {
      // What came before it is kept.
      writer->Commit().IgnoreError();
      return status;
    }
    if (writer->uncommitted() >= kCommitBytes) {
      TACTUS_RETURN_IF_ERROR(writer->Commit());
    }
    const absl::Status read = ReadMessage(stream, &request, &more);
    if (!read.ok()) {
      writer->Commit().IgnoreError();
      return read;
    }
  }
  TACTUS_RETURN_IF_ERROR(writer->Commit());
  v1::WriteUploadResponse response;
  response.set_committed_size(writer->committed_size());
  return WriteMessage(stream, response);
}

}  // namespace

void AddUploadRpcs(TrainingBackend* backend, ControlService& control) {
  const auto add = [&](const std::string& method,
                       ControlService::Handler handler) {
    AddRpc(backend, control, kUploadService + method, Role::kTrainer,
           std::move(handler));
  };
  add("CreateUpload",
      Unary<v1::CreateUploadRequest, v1::CreateUploadResponse>(
          [=](const auto& request, const Caller& caller)
              -> absl::StatusOr<v1::CreateUploadResponse> {
            TACTUS_ASSIGN_OR_RETURN(
                const v1::StoredUpload upload,
                backend->uploads().Create(
                    request.dataset(), request.request_id(), request.replace(),
                    caller, request.replace_labels()));
            v1::CreateUploadResponse response;
            response.set_upload(upload.name());
            response.set_committed_size(upload.committed_size());
            return response;
          }));
  add("WriteUpload",
      [=](ControlStream& stream) { return WriteUpload(*backend, stream); });
  add("QueryWriteStatus",
      Unary<v1::QueryWriteStatusRequest, v1::QueryWriteStatusResponse>(
          [=](const auto& request, const Caller& caller)
              -> absl::StatusOr<v1::QueryWriteStatusResponse> {
            TACTUS_ASSIGN_OR_RETURN(
                const v1::StoredUpload upload,
                backend->uploads().GetOwn(request.upload(), caller));
            v1::QueryWriteStatusResponse response;
            response.set_committed_size(upload.committed_size());
            response.set_dataset_version(upload.dataset_version());
            return response;
          }));
  add("FinishUpload",
      Unary<v1::FinishUploadRequest, v1::FinishUploadResponse>(
          [=](const auto& request, const Caller& caller)
              -> absl::StatusOr<v1::FinishUploadResponse> {
            v1::FinishUploadResponse response;
            uint32_t known = 0;
            std::vector<v1::TrialNote> notes;
            TACTUS_ASSIGN_OR_RETURN(
                *response.mutable_version(),
                backend->uploads().Finish(request.upload(), request.size(),
                                          request.crc32c(), caller, &known,
                                          &notes));
            response.set_known_trials(known);
            response.mutable_notes()->Assign(notes.begin(), notes.end());
            return response;
          }));
}

}  // namespace tactus::internal::server
