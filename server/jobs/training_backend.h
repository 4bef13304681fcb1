// File: training_backend.h
//
// TrainingBackend: everything behind the services for data, jobs and models, on
// one data directory, or on the catalogue and the folder that several servers
// share.
//
//   TACTUS_ASSIGN_OR_RETURN(auto backend,
//                           TrainingBackend::Open(options, &registry));
//   backend->Start();
//   backend->datasets().List(100, "");
//   backend->Stop();
//
// Thread-safe. `registry` must outlive it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/limits.h"
#include "core/base/limits_training.h"
#include "core/postgres/postgres_catalog.h"
#include "core/store/data_directory.h"
#include "server/jobs/job_queue.h"
#include "server/records/dataset_store.h"
#include "server/records/memory_budget.h"
#include "server/records/model_store.h"
#include "server/records/operation_store.h"
#include "server/records/quotas.h"
#include "server/records/upload_store.h"
#include "server/registry/model_registry.h"
#include "server/replicas/replica.h"
#include "server/replicas/shared_locks.h"

namespace tactus::internal::server {

class TrainingBackend {
 public:
  // A catalogue that several servers share.
  struct Shared {
    // Address of the database, postgresql://...; empty without one.
    std::string catalog = {};
    // Where it listens; empty for a worker.
    std::string address = {};
    Replica::Pace pace = {};
    // A folder on this server's own disk, for copies of blobs that were read
    // (BlobCache), and their bytes; 0: none are kept.
    std::string own_folder = {};
    int64_t blob_cache_bytes = 0;
  };

  struct Options {
    // The data directory; with a shared catalogue, the folder that its servers
    // share (DataDirectory::OpenShared).
    std::string folder = {};
    Shared shared = {};
    // False: others run them.
    bool runs_jobs = true;
    JobQueue::Options jobs = {};
    // Milliseconds since 1970 (UTC); the system's clock if empty.
    NowMs now = {};
    // What each client may have.
    Quotas quotas = {.stored_bytes = limits::kMaxClientBytes,
                     .datasets = limits::kMaxClientDatasets,
                     .queued_jobs = limits::kMaxClientQueuedJobs,
                     .model_bytes = limits::kMaxClientModelBytes};
    // Which jobs that have ended are kept.
    Retention retention = {};
    // How often abandoned uploads and old jobs are removed, beside at the
    // start.
    int64_t sweep_interval_ms = limits::kSweepIntervalMs;
  };

  // Opens the data directory and loads the stored models into `registry`, whose
  // built-in models were added before. The errors of DataDirectory::Open.
  static absl::StatusOr<std::unique_ptr<TrainingBackend>> Open(
      const Options& options, ModelRegistry* registry);

  // Stops.
  ~TrainingBackend();

  // Removes abandoned uploads and old jobs, now and from time to time; begins
  // to run jobs.
  void Start();
  // Ends waits and jobs. Jobs go on after the next start.
  void Stop();

  // Stored versions that could not be loaded, each with its error.
  std::vector<std::string> failures() const { return models_.failures(); }

  DataDirectory& data() { return *parts_.data; }
  DatasetStore& datasets() { return datasets_; }
  UploadStore& uploads() { return uploads_; }
  OperationStore& operations() { return operations_; }
  ModelStore& models() { return models_; }
  JobQueue& jobs() { return jobs_; }
  // This server among those of its catalogue; null if it is alone.
  Replica* replica() { return parts_.replica.get(); }
  const Quotas& quotas() const { return quotas_; }
  // Memory of the lists of trials that calls hold for a moment.
  MemoryBudget& listing() { return listing_; }
  // Memory that downloads hold until their clients have read everything.
  MemoryBudget& downloads() { return downloads_; }
  int64_t now_ms() const { return now_(); }

 private:
  // In the order in which they are made. Without a shared catalogue, only the
  // last.
  struct Parts {
    std::unique_ptr<Catalog> catalog;
    std::unique_ptr<Replica> replica;
    std::unique_ptr<SharedLocks> locks;
    std::unique_ptr<DataDirectory> data;
  };

  static absl::StatusOr<Parts> OpenParts(const Options& options);
  TrainingBackend(Parts parts, const Options& options, ModelRegistry* registry);
  void Sweep();
  // Deletes what lies in a shared folder and nobody needs.
  void LogCache();
  absl::Status SweepShared();
  // The catalogue has changed, perhaps.
  void OnNews(bool of_replicas);
  // Serves what it says.
  absl::Status FollowModels();

  const NowMs now_;
  const Parts parts_;
  const std::string catalog_;
  const bool runs_jobs_;
  const Quotas quotas_;
  const std::chrono::milliseconds sweep_interval_;
  DatasetStore datasets_;
  UploadStore uploads_;
  OperationStore operations_;
  ModelStore models_;
  JobQueue jobs_;
  MemoryBudget listing_{limits::kMaxListingBytes};
  MemoryBudget downloads_{limits::kMaxDownloadBytes};
  std::unique_ptr<CatalogNews> news_;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::thread sweeper_;
};

}  // namespace tactus::internal::server
