#include "client/training/trial_downloader.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "core/base/crc32c.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/data/trial_pack.h"
#include "core/data/trial_record.h"

namespace tactus::internal::client {
namespace {

class Download {
 public:
  Download(TrainingClient& client, const std::string& version,
           const std::function<absl::Status(const Trial&)>& sink,
           const DownloadOptions& options)
      : client_(client),
        version_(version),
        options_(options),
        unpacker_([&sink](const v1::TrialRecord& record) -> absl::Status {
          TACTUS_ASSIGN_OR_RETURN(const Trial trial, FromRecord(record));
          return sink(trial);
        }) {}

  absl::StatusOr<DownloadTotals> Run() {
    Retries retries(options_.retry, ExtendCrc32c(0, version_));
    for (;;) {
      const int64_t before = size_;
      const absl::Status status = ReadOnce();
      if (status.ok()) break;
      if (size_ > before) retries.Reset();
      TACTUS_RETURN_IF_ERROR(
          retries.WaitIf(may_repeat_ && MayRetry(status), status));
    }
    TACTUS_RETURN_IF_ERROR(unpacker_.Finish());
    return Totals();
  }

 private:
  DownloadTotals Totals() const { return {unpacker_.records(), size_}; }

  // Reads the whole pack in one call. Bytes before `size_` are known.
  absl::Status ReadOnce() {
    v1::DownloadTrialsRequest request;
    request.set_dataset_version(version_);
    // A download takes as long as it takes; the channel's keep-alive notices a
    // server that is gone.
    const auto context = client_.NewContext(std::chrono::milliseconds(0));
    const auto reader =
        client_.training().DownloadTrials(context.get(), request);
    v1::DownloadTrialsResponse response;
    int64_t at = 0;
    uint32_t crc32c = 0;
    while (reader->Read(&response)) {
      const absl::Status status = Take(response.data(), &at, &crc32c);
      if (status.ok()) continue;
      may_repeat_ = false;
      context->TryCancel();
      reader->Finish();
      return status;
    }
    const grpc::Status status = reader->Finish();
    if (!status.ok()) {
      return TrainingClient::ErrorOf(status, "DownloadTrials", {});
    }
    if (at < size_) {
      may_repeat_ = false;
      return InvalidResponse("size of the repeated trial pack", at,
                             absl::StrCat("at least ", size_));
    }
    return absl::OkStatus();
  }

  absl::Status Take(absl::string_view data, int64_t* at, uint32_t* crc32c) {
    if (*at < size_) {
      const auto known = data.substr(0, size_ - *at);
      *crc32c = ExtendCrc32c(*crc32c, known);
      *at += static_cast<int64_t>(known.size());
      data.remove_prefix(known.size());
      if (*at == size_ && *crc32c != crc32c_) {
        return InvalidResponse("CRC32C of the repeated trial pack", *crc32c,
                               absl::StrCat(crc32c_));
      }
    }
    if (data.empty()) return absl::OkStatus();
    crc32c_ = ExtendCrc32c(crc32c_, data);
    size_ += static_cast<int64_t>(data.size());
    *at = size_;
    *crc32c = crc32c_;
    TACTUS_RETURN_IF_ERROR(unpacker_.Add(data));
    if (options_.on_progress) options_.on_progress(Totals());
    return absl::OkStatus();
  }

  TrainingClient& client_;
  const std::string& version_;
  const DownloadOptions& options_;
  TrialUnpacker unpacker_;
  // Size and checksum of the pack, as far as the unpacker has it.
  int64_t size_ = 0;
  uint32_t crc32c_ = 0;
  bool may_repeat_ = true;
};

}  // namespace

absl::StatusOr<DownloadTotals> DownloadTrials(
    TrainingClient& client, const std::string& version,
    const std::function<absl::Status(const Trial&)>& sink,
    const DownloadOptions& options) {
  return Download(client, version, sink, options).Run();
}

}  // namespace tactus::internal::client
