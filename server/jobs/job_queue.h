// File: job_queue.h
//
// JobQueue: runs queued operations, one after another, each in a process of the
// program tactus-trainer, and stores what they make.
//
//   JobQueue jobs(data, &datasets, &models, &operations, options, now);
//   jobs.Start();
//   jobs.Wake();                     // after OperationStore::Create
//   jobs.Cancel("operations/3");
//   jobs.Stop();
//
// A job whose process ends without a result starts again from its checkpoints,
// at most Options::attempts times since the server started; then it fails with
// JOB_CRASHED. If the server ends, its jobs go on when it starts again, or at
// another server of the same catalogue. A server that only was slow, and whose
// job another one has, stores nothing of it any more.
//
// Training has one thread, evaluation and promotion another, so that a
// promotion never waits for a training. Thread-safe. What it is given must
// outlive it.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/data_directory.h"
#include "server/jobs/job_process.h"
#include "server/jobs/job_run.h"
#include "server/jobs/retry_log.h"
#include "server/jobs/slurm_job.h"
#include "server/records/caller.h"
#include "server/records/dataset_store.h"
#include "server/records/model_store.h"
#include "server/records/operation_store.h"
#include "server/records/pinned_version.h"

namespace tactus::internal::server {

class JobQueue {
 public:
  struct Options {
    JobProcess::Options process = {};
    // What starts the process of a training (JobProcess::Options::launcher).
    std::vector<std::string> training_launcher = {};
    // Trainings run on a Slurm cluster, if that is set.
    std::optional<SlurmJob::Options> slurm = {};
    int attempts = 3;
    // Between two writes of the learning curve.
    std::chrono::milliseconds store_interval{500};
    // Name of this machine, kept with the versions that are made.
    std::string host = {};
  };

  JobQueue(DataDirectory* data, DatasetStore* datasets, ModelStore* models,
           OperationStore* operations, Options options, NowMs now);
  ~JobQueue();

  void Start();
  // Kills the running processes; their jobs go on after the next start.
  void Stop();
  // Looks for queued operations.
  void Wake();
  // A queued job is CANCELLED at once, a running one CANCELLING.
  absl::StatusOr<v1::Operation> Cancel(absl::string_view name);
  // The end of what the job's processes wrote to standard error, at most
  // limits::kMaxJobLogBytes; it stays when the job has ended.
  absl::StatusOr<v1::StoredLog> Log(absl::string_view name) const;

 private:
  void Serve(bool training);
  // An operation and the right to run it.
  struct Job {
    std::string name;
    std::unique_ptr<Lock> lock;
  };
  // The oldest operation of this kind that waits, or whose server died; without
  // a name if there is none.
  Job NextJob(bool training);
  void Run(const Job& job, bool training);
  // False if another server goes on with the job.
  bool IsOwn(const Job& job) const;
  // The end of the file "log" of a job's folder; nothing if there is no file.
  absl::StatusOr<std::optional<v1::StoredLog>> ReadLog(
      const std::string& id) const;
  // Puts that into the catalogue.
  void KeepLog(const std::string& name, const std::string& id);
  // Removes the folders of jobs that ended when the server did.
  void RemoveFolders();
  void RemoveFolder(const std::string& name);
  // Logs an error of storage, unless it did lately. Waits a second, or until
  // the queue stops.
  void Rest(bool training, absl::string_view what, const absl::Status& error);
  // Starts the process of a job, and returns how the operation ends: OK with
  // the result in `operation`, or why it failed.
  absl::Status RunProcess(const Lock& lock, v1::Operation& operation);
  absl::StatusOr<std::unique_ptr<JobRun>> Start(
      const v1::Operation& operation, const std::string& folder) const;
  // The error of a process that ended without an outcome.
  absl::Status Explain(const std::string& name, const std::string& folder,
                       const JobRun::End& end) const;
  // The SHA-256 of a version's bundle; empty for a built-in one, which is no
  // blob and is written to `file`.
  absl::StatusOr<std::string> GiveModel(const std::string& version,
                                        const std::string& file) const;
  // `status`, or that a model of the operation was deleted.
  absl::Status ExplainModels(const v1::Operation& operation,
                             const absl::Status& status) const;
  // Writes the input of a job's process. Returns the dataset version that it
  // works on.
  absl::StatusOr<PinnedVersion> WriteSpec(const v1::Operation& operation,
                                          const std::string& folder) const;
  absl::Status Follow(const Lock& lock, const std::string& name, JobRun& run);
  absl::Status TakeOutcome(const Lock& lock, const std::string& folder,
                           v1::Operation& operation);
  absl::Status Publish(const Lock& lock, const std::string& folder,
                       v1::Operation& operation);
  absl::Status MoveAlias(const Lock& lock, v1::Operation& operation);
  // Whether somebody has cancelled it at another server.
  void LookForCancellation(const std::string& name);
  bool IsCancelled(const std::string& name) const;

  DataDirectory* const data_;
  DatasetStore* const datasets_;
  ModelStore* const models_;
  OperationStore* const operations_;
  const Options options_;
  const NowMs now_;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  // Number of calls of Wake.
  uint64_t wakes_ = 0;
  std::set<std::string> cancelled_;
  // How often a job's process was interrupted; by `training`, each of its
  // thread alone.
  std::map<std::string, int> interruptions_[2];
  // Errors of storage, likewise.
  RetryLog storage_[2];
  std::atomic<bool> stopping_ = false;
  std::thread training_;
  std::thread others_;
};

}  // namespace tactus::internal::server
