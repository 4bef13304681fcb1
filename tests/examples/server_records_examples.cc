// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <unistd.h>

#include <chrono>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "core/base/limits_training.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/store/records.h"
#include "core/train/fit.h"
#include "server/jobs/command.h"
#include "server/jobs/event_bytes.h"
#include "server/jobs/job_process.h"
#include "server/jobs/job_queue.h"
#include "server/jobs/job_run.h"
#include "server/jobs/retry_log.h"
#include "server/jobs/slurm_job.h"
#include "server/jobs/training_backend.h"
#include "server/names/resource_names.h"
#include "server/records/audit_log.h"
#include "server/records/blob_parts.h"
#include "server/records/dataset_skin.h"
#include "server/records/dataset_store.h"
#include "server/records/memory_budget.h"
#include "server/records/model_store.h"
#include "server/records/operation_removal.h"
#include "server/records/operation_store.h"
#include "server/records/paging.h"
#include "server/records/pinned_version.h"
#include "server/records/quotas.h"
#include "server/records/request_key.h"
#include "server/records/spool.h"
#include "server/records/trial_info.h"
#include "server/records/trial_merge.h"
#include "server/records/trial_taker.h"
#include "server/records/upload_store.h"
#include "server/trainer/compare.h"
#include "server/trainer/event_writer.h"
#include "server/trainer/exit_status.h"
#include "server/trainer/file_journal.h"
#include "server/trainer/job.h"
#include "server/trainer/job_files.h"
#include "spdlog/spdlog.h"

namespace tactus::internal::server::examples {

void Use();

static absl::Status ResourceNamesExample() {
#include "server/names/resource_names.h.inc"
  return absl::OkStatus();
}

static absl::Status AuditExample(Transaction& change, const Catalog& catalog,
                                 const Caller& caller, int64_t now,
                                 const std::string& name) {
#include "server/records/audit_log.h.inc"
  return absl::OkStatus();
}

static absl::Status TrialInfoExample(const v1::TrialRecord& record,
                                     const Trial& trial,
                                     const std::string& sha256,
                                     const std::string& bytes, BlobStore& blobs,
                                     BlobStore::Batch& batch) {
#include "server/records/trial_info.h.inc"
  return absl::OkStatus();
}

static absl::Status TrialMergeExample(
    const std::vector<v1::TrialInfo>& held,
    const std::vector<v1::TrialInfo>& uploaded) {
#include "server/records/trial_merge.h.inc"
  return absl::OkStatus();
}

static absl::Status DatasetSkinExample(const BlobStore& blobs,
                                       const std::vector<v1::TrialInfo>& held,
                                       const Trial& trial) {
#include "server/records/dataset_skin.h.inc"
  return absl::OkStatus();
}

static void RequestKeyExample(Transaction& change, const Caller& caller,
                              const std::string& id, const std::string& key) {
#include "server/records/request_key.h.inc"
}

static absl::Status QuotasExample(DataDirectory* data, const Quotas& quotas,
                                  const std::string& client, int64_t more,
                                  const std::string& key,
                                  const v1::StoredUpload& upload) {
#include "server/records/quotas.h.inc"
}

static absl::Status PagingExample(const v1::ListDatasetsRequest& request) {
#include "server/records/paging.h.inc"
  return absl::OkStatus();
}

static absl::Status TrialTakerExample(
    BlobStore& blobs, MemoryBudget& parsing, absl::string_view chunk,
    std::function<absl::StatusOr<std::string>(int64_t, int64_t)> read) {
#include "server/records/trial_taker.h.inc"
}

static void DatasetStoreExample(DataDirectory* data, const NowMs& now,
                                const Caller& caller) {
#include "server/records/dataset_store.h.inc"
}

void Parse(absl::string_view) {}
bool GiveUp() { return false; }

static bool MemoryBudgetExample(absl::string_view bytes, MemoryBudget& known) {
#include "server/records/memory_budget.h.inc"
  return true;
}

static absl::Status OperationRemovalExample(Transaction& change,
                                            Transaction& look,
                                            const v1::Operation& operation,
                                            int64_t now_ms) {
#include "server/records/operation_removal.h.inc"
  return absl::OkStatus();
}

static absl::Status SpoolExample(const DataDirectory& data,
                                 absl::string_view part) {
#include "server/records/spool.h.inc"
  return absl::OkStatus();
}

static absl::Status BlobPartsExample(
    const DataDirectory& data, const std::string& sha256, int64_t limit,
    absl::FunctionRef<absl::Status(absl::string_view)> send) {
#include "server/records/blob_parts.h.inc"
  return absl::OkStatus();
}

static absl::Status CallerExample(const Caller& caller,
                                  const v1::StoredUpload& upload) {
#include "server/records/caller.h.inc"
  return absl::OkStatus();
}

static absl::Status PinnedVersionExample(const DataDirectory& data,
                                         const DatasetStore& datasets,
                                         v1::Operation operation) {
#include "server/records/pinned_version.h.inc"
  return absl::OkStatus();
}

static absl::Status UploadStoreExample(UploadStore& uploads,
                                       const Caller& caller,
                                       const std::string& request_id,
                                       int64_t offset, const std::string& chunk,
                                       uint32_t crc32c, int64_t size) {
#include "server/records/upload_store.h.inc"
  return absl::OkStatus();
}

static void OperationStoreExample(OperationStore& operations,
                                  const v1::Operation& request,
                                  const std::string& request_id,
                                  const Caller& caller, const std::string& name,
                                  std::chrono::milliseconds timeout) {
  OperationStore::Cursor cursor;
#include "server/records/operation_store.h.inc"
}

static absl::Status ModelStoreExample(DataDirectory* data,
                                      ModelRegistry& registry, const NowMs& now,
                                      const std::string& bundle,
                                      const v1::ModelVersion& origin,
                                      const v1::PromoteSpec& spec,
                                      const Caller& caller) {
#include "server/records/model_store.h.inc"
  return absl::OkStatus();
}

static absl::Status JobProcessExample(const JobProcess::Options& options,
                                      const std::string& folder,
                                      std::chrono::milliseconds timeout,
                                      std::chrono::milliseconds patience) {
#include "server/jobs/job_process.h.inc"
  return absl::OkStatus();
}

static absl::Status ExitStatusExample(const JobProcess::End& end,
                                      const std::string& folder) {
#include "server/trainer/exit_status.h.inc"
  return absl::OkStatus();
}

static void JobFilesExample(FileSystem& files, const std::string& folder) {
#include "server/trainer/job_files.h.inc"
}

static void JobQueueExample(DataDirectory* data, DatasetStore& datasets,
                            ModelStore& models, OperationStore& operations,
                            const JobQueue::Options& options,
                            const NowMs& now) {
#include "server/jobs/job_queue.h.inc"
}

static absl::Status TrainingBackendExample(
    const TrainingBackend::Options& options, ModelRegistry& registry) {
#include "server/jobs/training_backend.h.inc"
  return absl::OkStatus();
}

static void CompareExample(const Evaluation& evaluation,
                           const Evaluation& current,
                           const Evaluation& candidate, uint32_t never_felt,
                           const v1::JobGate& gate) {
#include "server/trainer/compare.h.inc"
}

static void EventWriterExample(
    const std::vector<const LabelledContact*>& contacts,
    const FitOptions& options, const ParallelFor& parallel,
    FileJournal& journal) {
  LoneTeam team;
#include "server/trainer/event_writer.h.inc"
}

static void FileJournalExample(
    const std::string& folder, EventWriter& events,
    const std::vector<const LabelledContact*>& contacts,
    const FitOptions& options, const ParallelFor& parallel) {
#include "server/trainer/file_journal.h.inc"
}

struct Job {};
int Run(const Job& job);
absl::Status Store();

static void RunOnThreadsExample(
    const std::vector<Job>& jobs, std::vector<int>& results,
    const std::vector<const LabelledContact*>& contacts,
    const FitOptions& options) {
#include "core/base/run_on_threads.h.inc"
}

void Use(const v1::JobEvent& event);

static void JobRunExample(JobRun& run, std::chrono::milliseconds timeout,
                          std::chrono::milliseconds patience) {
#include "server/jobs/job_run.h.inc"
}

static void EventBytesExample(const std::string& read_now) {
#include "server/jobs/event_bytes.h.inc"
}

static absl::Status CommandExample() {
#include "server/jobs/command.h.inc"
  return absl::OkStatus();
}

static absl::Status SlurmJobExample(const SlurmJob::Options& options,
                                    const std::string& folder,
                                    std::chrono::milliseconds timeout,
                                    std::chrono::milliseconds patience) {
#include "server/jobs/slurm_job.h.inc"
  return absl::OkStatus();
}

static void RetryLogExample() {
#include "server/jobs/retry_log.h.inc"
}

static void JobExample(FileSystem& files, const std::string& folder,
                       EventWriter& events, FileJournal& journal, Team& team) {
#include "server/trainer/job.h.inc"
}

}  // namespace tactus::internal::server::examples
