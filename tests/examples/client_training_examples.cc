// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <optional>
#include <string>
#include <thread>

#include "client/stream/backoff.h"
#include "client/training/admin_client.h"
#include "client/training/operation_watcher.h"
#include "client/training/retry.h"
#include "client/training/training_client.h"
#include "client/training/trial_downloader.h"
#include "client/training/trial_pack.h"
#include "client/training/trial_packer.h"
#include "client/training/trial_uploader.h"
#include "core/base/status_macros.h"
#include "core/data/trial_file.h"
#include "core/data/trial_record.h"

namespace tactus::client::examples {

bool Try();
absl::Status Send();
absl::Status Store(const v1::TrialRecord& record);
void Show(const v1::Operation& now, std::span<const v1::LearningPoint> points);

void BackoffExample(uint64_t seed) {
  Backoff backoff(seed);
  while (!Try()) std::this_thread::sleep_for(backoff.Next());
  backoff.Reset();  // after a success
}

absl::Status AdminClientExample(TrainingClient& client) {
  AdminClient admin(&client);
  TACTUS_ASSIGN_OR_RETURN(const auto info, admin.GetServerInfo());
  return absl::OkStatus();
}

absl::Status RetryExample() {
  Retries retries({}, /*seed=*/1);
  for (;;) {
    const absl::Status status = Send();
    if (status.ok()) return status;
    TACTUS_RETURN_IF_ERROR(retries.Wait(status));
  }
}

absl::Status TrialPackExample(const Trial& trial) {
  std::string pack;
  TACTUS_RETURN_IF_ERROR(AppendToPack(ToRecord(trial), &pack));

  TrialUnpacker unpacker(
      [](const v1::TrialRecord& record) { return Store(record); });
  TACTUS_RETURN_IF_ERROR(unpacker.Add(pack));  // any part of a pack
  TACTUS_RETURN_IF_ERROR(unpacker.Finish());
  return absl::OkStatus();
}

absl::Status TrainingClientExample() {
  TrainingClient client(MakeTrainingChannel("arm.lab:50051", {}));
  TACTUS_ASSIGN_OR_RETURN(const v1::Dataset dataset,
                          client.CreateDataset("datasets/arm", "first arm"));
  return absl::OkStatus();
}

absl::Status TrialPackerExample(
    const NextTrial& next_trial,
    const std::function<void(int64_t, const std::string&)>& send) {
  TrialPacker packer(next_trial, {.chunk_bytes = 1 << 20});
  while (true) {
    TACTUS_ASSIGN_OR_RETURN(const PackChunk chunk, packer.Next());
    if (chunk.data.empty()) break;
    send(chunk.offset, chunk.data);
  }
  return absl::OkStatus();
}

absl::Status TrialUploaderExample(TrainingClient& client,
                                  TrialFileReader reader) {
  v1::CreateUploadRequest request;
  request.set_dataset("datasets/arm");
  request.set_request_id("arm-1");
  TrialUploader uploader(&client, {});
  size_t next = 0;
  TACTUS_ASSIGN_OR_RETURN(
      const v1::FinishUploadResponse made,
      uploader.Upload(request, [&]() -> absl::StatusOr<std::optional<Trial>> {
        if (next == reader.size()) return std::nullopt;
        return reader.Read(next++);
      }));
  return absl::OkStatus();
}

absl::Status TrialDownloaderExample(TrainingClient& client,
                                    TrialFileWriter writer) {
  TACTUS_ASSIGN_OR_RETURN(
      const DownloadTotals totals,
      DownloadTrials(client, "datasets/arm/versions/3",
                     [&](const Trial& trial) { return writer.Append(trial); },
                     {}));
  return absl::OkStatus();
}

absl::Status OperationWatcherExample(TrainingClient& client) {
  OperationWatcher watcher(&client, {});
  TACTUS_ASSIGN_OR_RETURN(
      const v1::Operation ended,
      watcher.Watch("operations/7",
                    [](const v1::Operation& now, const auto& new_points) {
                      Show(now, new_points);
                    }));
  return absl::OkStatus();
}

}  // namespace tactus::client::examples
