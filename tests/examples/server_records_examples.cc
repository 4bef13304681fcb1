// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
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
#include "server/jobs/job_process.h"
#include "server/jobs/job_queue.h"
#include "server/jobs/retry_log.h"
#include "server/jobs/training_backend.h"
#include "server/names/resource_names.h"
#include "server/records/audit_log.h"
#include "server/records/blob_parts.h"
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
#include "server/records/trial_merge.h"
#include "server/records/trial_taker.h"
#include "server/records/upload_store.h"
#include "server/trainer/compare.h"
#include "server/trainer/event_writer.h"
#include "server/trainer/exit_status.h"
#include "server/trainer/file_journal.h"
#include "server/trainer/job.h"
#include "spdlog/spdlog.h"

namespace tactus::server::examples {

void Use();

absl::Status ResourceNamesExample() {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName name,
                          ParseName("datasets/grasps/versions/2", "datasets"));
  CatalogKey(name);  // "grasps/0000000002"
  return absl::OkStatus();
}

absl::Status AuditExample(Transaction& change, const Catalog& catalog,
                          const Caller& caller, int64_t now,
                          const std::string& name) {
  TACTUS_RETURN_IF_ERROR(Audit(change, caller, now, "create", name));
  auto page = ListAudit(catalog, 100, "", {.resource_prefix = "models/"});
  return absl::OkStatus();
}

absl::Status TrialMergeExample(const std::vector<v1::TrialInfo>& held,
                               const std::vector<v1::TrialInfo>& uploaded) {
  TACTUS_ASSIGN_OR_RETURN(
      const TrialMerge merge,
      MergeTrials(held, uploaded, {.replace_labels = true}));
  return absl::OkStatus();
}

void RequestKeyExample(Transaction& change, const Caller& caller,
                       const std::string& id, const std::string& key) {
  change.Put(Table::kRequests, RequestKey("operation", caller, id), key);
}

absl::Status QuotasExample(DataDirectory* data, const Quotas& quotas,
                           const std::string& client, int64_t more,
                           const std::string& key,
                           const v1::StoredUpload& upload) {
  return data->catalog().Change([&](Transaction& change) -> absl::Status {
    TACTUS_RETURN_IF_ERROR(CheckStoredBytes(change, quotas, client, more));
    return PutRecord(change, Table::kUploads, key, upload);
  });
}

absl::Status PagingExample(const v1::ListDatasetsRequest& request) {
  TACTUS_ASSIGN_OR_RETURN(int size, PageSize(request.page_size()));
  return absl::OkStatus();
}

absl::Status TrialTakerExample(
    BlobStore& blobs, MemoryBudget& parsing, absl::string_view chunk,
    std::function<absl::StatusOr<std::string>(int64_t, int64_t)> read) {
  TrialTaker taker({.blobs = &blobs, .parsing = &parsing, .read = read});
  TACTUS_RETURN_IF_ERROR(taker.Add(chunk));
  TACTUS_RETURN_IF_ERROR(taker.End());
  uint32_t known = 0;
  return taker.Commit(&known);
}

void DatasetStoreExample(DataDirectory* data, const NowMs& now,
                         const Caller& caller) {
  DatasetStore datasets(data, now);
  auto dataset = datasets.Create("datasets/grasps", "", caller);
  auto version = datasets.Version("datasets/grasps");
}

void Parse(absl::string_view) {}
bool GiveUp() { return false; }

bool MemoryBudgetExample(absl::string_view bytes, MemoryBudget& known) {
  MemoryBudget parsing(limits::kMaxParsingBytes);
  {
    const MemoryBudget::Lease lease = parsing.Take(bytes.size());
    Parse(bytes);
  }
  if (!known.TryTake(512)) return GiveUp();
  known.Return(512);
  return true;
}

absl::Status OperationRemovalExample(Transaction& change, Transaction& look,
                                     const v1::Operation& operation,
                                     int64_t now_ms) {
  TACTUS_RETURN_IF_ERROR(RemoveOperation(change, operation));
  TACTUS_ASSIGN_OR_RETURN(const auto old,
                          OldOperations(look, {.jobs = 1000}, now_ms, 100));
  return absl::OkStatus();
}

absl::Status SpoolExample(const DataDirectory& data, absl::string_view part) {
  TACTUS_ASSIGN_OR_RETURN(const auto spool, Spool::Create(data));
  TACTUS_RETURN_IF_ERROR(spool->Append(part));
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes, spool->Read());
  return absl::OkStatus();
}

absl::Status BlobPartsExample(
    const DataDirectory& data, const std::string& sha256, int64_t limit,
    absl::FunctionRef<absl::Status(absl::string_view)> send) {
  TACTUS_RETURN_IF_ERROR(ReadBlobParts(data, sha256, limit, send));
  return absl::OkStatus();
}

absl::Status CallerExample(const Caller& caller,
                           const v1::StoredUpload& upload) {
  TACTUS_RETURN_IF_ERROR(CheckOwner(caller, upload.name(), upload.requester()));
  return absl::OkStatus();
}

absl::Status PinnedVersionExample(const DataDirectory& data,
                                  const DatasetStore& datasets,
                                  v1::Operation operation) {
  TACTUS_ASSIGN_OR_RETURN(
      const auto version,
      PinnedVersion::Find(data, datasets, "datasets/grasps"));
  operation.mutable_train()->set_dataset_version(version.name());
  TACTUS_ASSIGN_OR_RETURN(const auto trials, version.Trials());
  return absl::OkStatus();
}

absl::Status UploadStoreExample(UploadStore& uploads, const Caller& caller,
                                const std::string& request_id, int64_t offset,
                                const std::string& chunk, uint32_t crc32c,
                                int64_t size) {
  auto upload = uploads.Create("datasets/grasps", request_id, false, caller);
  {
    TACTUS_ASSIGN_OR_RETURN(auto writer, uploads.Write(upload->name(), caller));
    TACTUS_RETURN_IF_ERROR(writer->Append(offset, chunk, crc32c));
    TACTUS_RETURN_IF_ERROR(writer->Commit());  // now on disk
  }
  uint32_t known = 0;
  auto version = uploads.Finish(upload->name(), size, crc32c, caller, &known);
  return absl::OkStatus();
}

void OperationStoreExample(OperationStore& operations,
                           const v1::Operation& request,
                           const std::string& request_id, const Caller& caller,
                           const std::string& name,
                           std::chrono::milliseconds timeout) {
  OperationStore::Cursor cursor;
  auto operation = operations.Create(request, request_id, caller);
  auto changed = operations.Change(name, [](v1::Operation& operation) {
    operation.set_state(v1::Operation::STATE_RUNNING);
    return absl::OkStatus();
  });
  auto update = operations.WaitForChange(name, &cursor, timeout);
}

absl::Status ModelStoreExample(DataDirectory* data, ModelRegistry& registry,
                               const NowMs& now, const std::string& bundle,
                               const v1::ModelVersion& origin,
                               const v1::PromoteSpec& spec,
                               const Caller& caller) {
  ModelStore models(data, &registry, now);
  TACTUS_RETURN_IF_ERROR(models.Restore().status());
  auto version = models.AddVersion("models/grasps", bundle, origin, caller);
  auto alias = models.Promote(spec, /*forced=*/false, caller);
  return absl::OkStatus();
}

absl::Status JobProcessExample(const JobProcess::Options& options,
                               const std::string& folder,
                               std::chrono::milliseconds timeout,
                               std::chrono::milliseconds patience) {
  TACTUS_ASSIGN_OR_RETURN(auto process, JobProcess::Start(options, folder));
  v1::JobEvent event;
  while (process->Next(timeout, &event) != JobProcess::News::kClosed) Use();
  const JobProcess::End end = process->Wait(patience);
  return absl::OkStatus();
}

absl::Status ExitStatusExample(const JobProcess::End& end,
                               const std::string& folder) {
  if (end.status == kExitStorageFull) return StorageFull(folder, "...");
  return absl::OkStatus();
}

void JobQueueExample(DataDirectory* data, DatasetStore& datasets,
                     ModelStore& models, OperationStore& operations,
                     const JobQueue::Options& options, const NowMs& now) {
  JobQueue jobs(data, &datasets, &models, &operations, options, now);
  jobs.Start();
  jobs.Wake();  // after OperationStore::Create
  jobs.Cancel("operations/3");
  jobs.Stop();
}

absl::Status TrainingBackendExample(const TrainingBackend::Options& options,
                                    ModelRegistry& registry) {
  TACTUS_ASSIGN_OR_RETURN(auto backend,
                          TrainingBackend::Open(options, &registry));
  backend->Start();
  backend->datasets().List(100, "");
  backend->Stop();
  return absl::OkStatus();
}

void CompareExample(const Evaluation& evaluation, const Evaluation& current,
                    const Evaluation& candidate, uint32_t never_felt,
                    const v1::JobGate& gate) {
  const v1::EvaluationReport report = ReportOf(evaluation, never_felt);
  const v1::Comparison comparison =
      Compare(current, candidate, never_felt, gate);
}

void EventWriterExample(const std::vector<const LabelledContact*>& contacts,
                        const FitOptions& options, const ParallelFor& parallel,
                        FileJournal& journal) {
  EventWriter events(STDOUT_FILENO);
  FitModel(contacts, options, parallel, events.progress(), &journal);
}

void FileJournalExample(const std::string& folder, EventWriter& events,
                        const std::vector<const LabelledContact*>& contacts,
                        const FitOptions& options,
                        const ParallelFor& parallel) {
  FileJournal journal(PosixFileSystem(), folder + "/parts", &events);
  FitModel(contacts, options, parallel, events.progress(), &journal);
}

struct Job {};
int Run(const Job& job);

void RunOnThreadsExample(const std::vector<Job>& jobs,
                         std::vector<int>& results,
                         const std::vector<const LabelledContact*>& contacts,
                         const FitOptions& options) {
  RunOnThreads(jobs.size(), [&](int i) { results[i] = Run(jobs[i]); });
  FitModel(contacts, options, RunOnThreads);
  FitModel(contacts, options, OnThreads(2));
}

absl::Status Store();

void RetryLogExample() {
  RetryLog log;
  while (!Store().ok()) {
    if (log.Fails()) spdlog::error("failed {} times", log.failures());
  }
  log.Succeeds();
}

void JobExample(FileSystem& files, const std::string& folder,
                EventWriter& events, FileJournal& journal) {
  const absl::Status status =
      RunJob(files, folder, {.start = OnThreads(2), .run = OnThreads(1)},
             &events, &journal);
}

}  // namespace tactus::server::examples
