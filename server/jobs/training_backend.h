// File: training_backend.h
//
// TrainingBackend: everything behind the services for data, jobs and models, on
// one data directory.
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
#include "core/store/data_directory.h"
#include "server/jobs/job_queue.h"
#include "server/records/dataset_store.h"
#include "server/records/memory_budget.h"
#include "server/records/model_store.h"
#include "server/records/operation_store.h"
#include "server/records/quotas.h"
#include "server/records/upload_store.h"
#include "server/registry/model_registry.h"

namespace tactus::internal::server {

class TrainingBackend {
 public:
  struct Options {
    std::string folder = {};
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
  const std::vector<std::string>& failures() const { return failures_; }

  DataDirectory& data() { return *data_; }
  DatasetStore& datasets() { return datasets_; }
  UploadStore& uploads() { return uploads_; }
  OperationStore& operations() { return operations_; }
  ModelStore& models() { return models_; }
  JobQueue& jobs() { return jobs_; }
  const Quotas& quotas() const { return quotas_; }
  // Memory of the lists of trials that calls hold for a moment.
  MemoryBudget& listing() { return listing_; }
  // Memory that downloads hold until their clients have read everything.
  MemoryBudget& downloads() { return downloads_; }
  int64_t now_ms() const { return now_(); }

 private:
  TrainingBackend(std::unique_ptr<DataDirectory> data, const Options& options,
                  ModelRegistry* registry);
  void Sweep();

  const NowMs now_;
  const std::unique_ptr<DataDirectory> data_;
  const Quotas quotas_;
  const std::chrono::milliseconds sweep_interval_;
  DatasetStore datasets_;
  UploadStore uploads_;
  OperationStore operations_;
  ModelStore models_;
  JobQueue jobs_;
  MemoryBudget listing_{limits::kMaxListingBytes};
  MemoryBudget downloads_{limits::kMaxDownloadBytes};
  std::vector<std::string> failures_;

  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::thread sweeper_;
};

}  // namespace tactus::internal::server
