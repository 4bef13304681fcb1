#include "server/training_flags.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "core/postgres/pg_connection.h"
#include "core/postgres/postgres_catalog.h"

namespace tactus::internal::server {
namespace {

std::string HostName() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

// The path of a program that a shell would find; empty without one.
std::string FindProgram(const std::string& name) {
  const char* const path = std::getenv("PATH");
  for (const auto folder : absl::StrSplit(path == nullptr ? "" : path, ':')) {
    std::string program = absl::StrCat(folder, "/", name);
    if (access(program.c_str(), X_OK) == 0) return program;
  }
  return "";
}

}  // namespace

void TrainingFlags::AddCatalog(CLI::App& app) {
  auto* const address =
      app.add_option("--catalog", catalog,
                     "postgresql://... of the catalogue that several servers "
                     "share, instead of one in --data-dir; the password is "
                     "better in PGPASSFILE")
          ->envname("TACTUSD_CATALOG")
          ->check(CLI::Validator(
              [](const std::string& text) {
                return IsPostgresAddress(text)
                           ? std::string()
                           : std::string("must begin with postgresql://");
              },
              "ADDRESS"));
  auto* const folder = app.add_option(
      "--blobs", blobs,
      "Folder for the bytes of datasets, jobs and models, which all servers of "
      "--catalog share");
  address->needs(folder);
  folder->needs(address);
}

void TrainingFlags::AddBlobCache(CLI::App& app) {
  app.add_option("--blob-cache", blob_cache,
                 "With --catalog: keep copies of the blobs that were read in "
                 "the data directory, in so many bytes, such as 1G, so that "
                 "they are not read again from the shared folder")
      ->needs("--catalog")
      ->needs("--data-dir")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/false))
      ->check(
          CLI::Range(static_cast<uint64_t>(kBytesPerMb), uint64_t{1} << 50));
}

void TrainingFlags::AddJobs(const std::vector<std::string>& who,
                            CLI::App& app) {
  app.add_option("--jobs", jobs,
                 "Who runs jobs: local, this process; slurm, a Slurm cluster "
                 "the trainings and this process the rest; none, others of "
                 "--catalog")
      ->check(CLI::IsMember(who))
      ->capture_default_str();
  app.add_option("--sbatch", sbatch,
                 "With --jobs=slurm: an argument of sbatch, like "
                 "--partition=long; may be repeated");
  app.add_option("--trainer", trainer,
                 "Program that runs jobs; default: tactus-trainer beside this "
                 "program");
  app.add_option("--job-memory-mb", job_memory_mb,
                 "Memory that a job may have; 0 for no limit")
      ->check(CLI::Range(int64_t{0}, int64_t{1} << 30))
      ->capture_default_str();
  app.add_option("--job-threads", job_threads,
                 "Threads of a job, or of each of its ranks; 0: one less than "
                 "there are processors, at "
                 "least 1, and all of them until the first iteration")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_option("--job-ranks", job_ranks,
                 "Processes that make one training together, by mpirun; the "
                 "model does not depend on their number")
      ->check(CLI::Range(1, limits::kMaxJobRanks))
      ->capture_default_str();
  app.add_option(
         "--job-hosts", job_hosts,
         "Hosts of the ranks, as mpirun --hostfile takes them; default: "
         "this one")
      ->check(CLI::ExistingFile);
}

void TrainingFlags::AddQuotas(CLI::App& app) {
  const auto quota = CLI::Range(int64_t{0}, int64_t{1} << 40);
  app.add_option(
         "--quota-stored-mb", quota_stored_mb,
         "Megabytes that one client may store: unfinished uploads, and "
         "trials that it added to datasets; 0 for no limit. A client is "
         "a token, a certificate or, without these, a host")
      ->check(quota)
      ->capture_default_str();
  app.add_option("--quota-datasets", quota_datasets,
                 "Datasets that one client may create; 0 for no limit")
      ->check(quota)
      ->capture_default_str();
  app.add_option("--quota-jobs", quota_jobs,
                 "Queued jobs that one client may have; 0 for no limit")
      ->check(quota)
      ->capture_default_str();
  app.add_option("--quota-models-mb", quota_models_mb,
                 "Megabytes of model versions that one client may make; all "
                 "are held in memory; 0 for no limit")
      ->check(quota)
      ->capture_default_str();
  app.add_option("--keep-jobs", keep_jobs,
                 "Jobs that have ended and are kept, the newest of each "
                 "client; 0 for all")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app.add_option("--keep-job-days", keep_job_days,
                 "How long jobs that have ended are kept; each client's newest "
                 "100 stay at any age; 0 for all")
      ->check(CLI::Range(int64_t{0}, int64_t{100'000}))
      ->capture_default_str();
}

// Beside this program unless the flags say otherwise.
std::string TrainingFlags::TrainerProgram() const {
  if (!trainer.empty()) return trainer;
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return (self.parent_path() / "tactus-trainer").string();
}

absl::Status TrainingFlags::Check() const {
  if (jobs != "slurm") return CheckRanks();
  for (const char* const program : {"sbatch", "scancel", "scontrol"}) {
    if (!FindProgram(program).empty()) continue;
    return InvalidConfig(
        "--jobs", jobs,
        absl::StrCat("local: there is no ", program, "; install slurm-client"));
  }
  return CheckRanks();
}

absl::Status TrainingFlags::CheckRanks() const {
  if (job_ranks == 1) return absl::OkStatus();
  const std::string program = TrainerProgram() + "-mpi";
  if (access(program.c_str(), X_OK) != 0) {
    return InvalidConfig("--job-ranks", job_ranks,
                         absl::StrCat("1: there is no ", program,
                                      ", which is built where libopenmpi-dev "
                                      "is installed"));
  }
  if (FindProgram("mpirun").empty()) {
    return InvalidConfig("--job-ranks", job_ranks,
                         "1: there is no mpirun; install openmpi-bin");
  }
  return absl::OkStatus();
}

TrainingBackend::Options TrainingFlags::Options(
    const std::string& address) const {
  JobProcess::Options process = {.program = TrainerProgram(),
                                 .memory_bytes = job_memory_mb * kBytesPerMb};
  // One processor remains for the streams, if there are several. Until the
  // first iteration, which somebody waits for, a job may have it too. Ranks on
  // one host share them.
  const int all = static_cast<int>(std::thread::hardware_concurrency());
  const int here = job_hosts.empty() ? job_ranks : 1;
  const bool asked = job_threads > 0;
  process.start_threads = asked ? job_threads : std::max(1, all / here);
  process.threads = asked ? job_threads : std::max(1, (all - 1) / here);
  std::vector<std::string> launcher;
  if (job_ranks > 1) {
    // Ranks that are bound to a processor would not give way to the streams.
    launcher = {"mpirun",    "-n",   absl::StrCat(job_ranks),
                "--bind-to", "none", "--oversubscribe"};
    if (!job_hosts.empty()) {
      launcher.insert(launcher.end(), {"--hostfile", job_hosts});
    }
  }
  std::optional<SlurmJob::Options> slurm;
  if (jobs == "slurm") {
    slurm = {.process = process, .ranks = job_ranks, .sbatch = sbatch};
    slurm->process.start_threads = slurm->process.threads =
        asked ? job_threads : 1;
  }
  return {.folder = catalog.empty() ? data_dir : blobs,
          .shared = {.catalog = catalog,
                     .address = address,
                     .own_folder = data_dir,
                     .blob_cache_bytes = static_cast<int64_t>(blob_cache)},
          .runs_jobs = jobs != "none",
          .jobs = {.process = process,
                   .training_launcher = launcher,
                   .slurm = slurm,
                   .host = HostName()},
          .quotas = {.stored_bytes = quota_stored_mb * kBytesPerMb,
                     .datasets = quota_datasets,
                     .queued_jobs = quota_jobs,
                     .model_bytes = quota_models_mb * kBytesPerMb},
          .retention = {.jobs = keep_jobs, .ms = keep_job_days * kMsPerDay}};
}

}  // namespace tactus::internal::server
