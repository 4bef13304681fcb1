// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <optional>
#include <string>
#include <thread>

#include "client/stream/backoff.h"
#include "client/training/admin_client.h"
#include "client/training/contact_log_client.h"
#include "client/training/monitor_client.h"
#include "client/training/operation_watcher.h"
#include "client/training/retry.h"
#include "client/training/training_client.h"
#include "client/training/trial_downloader.h"
#include "client/training/trial_packer.h"
#include "client/training/trial_uploader.h"
#include "core/base/status_macros.h"
#include "core/data/trial_file.h"
#include "core/data/trial_record.h"

namespace tactus::internal::client::examples {

bool Try();
absl::Status Send();
absl::Status Store(const v1::TrialRecord& record);
void Show(const v1::Operation& now, std::span<const v1::LearningPoint> points);

static void BackoffExample(uint64_t seed) {
#include "client/stream/backoff.h.inc"
}

static absl::Status AdminClientExample(TrainingClient& client) {
#include "client/training/admin_client.h.inc"
  return absl::OkStatus();
}

void Show(const v1::StreamUpdate& update);

static absl::Status ContactLogClientExample(
    TrainingClient& client, const v1::ListContactsRequest& request,
    const v1::LabelContactsRequest& labels) {
#include "client/training/contact_log_client.h.inc"
  return absl::OkStatus();
}

static absl::Status MonitorClientExample(TrainingClient& client) {
#include "client/training/monitor_client.h.inc"
  return absl::OkStatus();
}

static absl::Status RetryExample() {
#include "client/training/retry.h.inc"
}

static absl::Status TrainingClientExample() {
#include "client/training/training_client.h.inc"
  return absl::OkStatus();
}

static absl::Status TrialPackerExample(
    const NextTrial& next_trial,
    const std::function<void(int64_t, const std::string&)>& send) {
#include "client/training/trial_packer.h.inc"
  return absl::OkStatus();
}

static absl::Status TrialUploaderExample(TrainingClient& client,
                                         TrialFileReader reader) {
#include "client/training/trial_uploader.h.inc"
  return absl::OkStatus();
}

static absl::Status TrialDownloaderExample(TrainingClient& client,
                                           TrialFileWriter writer) {
#include "client/training/trial_downloader.h.inc"
  return absl::OkStatus();
}

static absl::Status OperationWatcherExample(TrainingClient& client) {
#include "client/training/operation_watcher.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::client::examples
