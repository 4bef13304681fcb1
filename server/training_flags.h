// File: training_flags.h
//
// TrainingFlags: the flags about data, jobs and models, which tactusd and
// tactus-worker share.
//
//   TrainingFlags flags;
//   flags.AddCatalog(app);
//   flags.AddJobs({"local", "none"}, app);
//   TACTUS_RETURN_IF_ERROR(flags.Check());
//   const TrainingBackend::Options options = flags.Options(address);
//   TACTUS_ASSIGN_OR_RETURN(auto backend,
//                           TrainingBackend::Open(options, &registry));
//
// The command line writes to the flags, which must not move after Add...().
// Not thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"
#include "core/base/limits.h"
#include "core/base/limits_training.h"
#include "server/jobs/training_backend.h"

namespace tactus::internal::server {

struct TrainingFlags {
  static constexpr int64_t kBytesPerMb = 1024L * 1024;
  static constexpr int64_t kMsPerDay = 24L * 3'600 * 1'000;

  std::string data_dir;
  std::string catalog;
  std::string blobs;
  // Bytes; 0: no blobs are kept here.
  uint64_t blob_cache = 0;
  std::string jobs = "local";
  std::string trainer;
  int64_t job_memory_mb = 0;
  int job_threads = 0;
  int job_ranks = 1;
  std::string job_hosts;
  std::vector<std::string> sbatch;
  int64_t quota_stored_mb = limits::kMaxClientBytes / kBytesPerMb;
  int64_t quota_datasets = limits::kMaxClientDatasets;
  int64_t quota_jobs = limits::kMaxClientQueuedJobs;
  int64_t quota_models_mb = limits::kMaxClientModelBytes / kBytesPerMb;
  int keep_jobs = limits::kMaxKeptJobs;
  int64_t keep_job_days = limits::kKeptJobMs / kMsPerDay;

  // --catalog and --blobs.
  void AddCatalog(CLI::App& app);
  // --blob-cache, which lies in the data directory beside --catalog.
  void AddBlobCache(CLI::App& app);
  // Who runs jobs, one of `who`, and how.
  void AddJobs(const std::vector<std::string>& who, CLI::App& app);
  // What each client may have, and which jobs are kept.
  void AddQuotas(CLI::App& app);

  // Whether there is anything to open.
  bool given() const { return !data_dir.empty() || !catalog.empty(); }
  // INVALID_CONFIG if jobs are to run with several ranks, or on a Slurm
  // cluster, and a program for that is missing.
  absl::Status Check() const;
  // `address`: where the server listens; empty for a worker.
  TrainingBackend::Options Options(const std::string& address) const;

 private:
  absl::Status CheckRanks() const;
  std::string TrainerProgram() const;
};

}  // namespace tactus::internal::server
