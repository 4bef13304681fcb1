// File: slurm_job.h
//
// SlurmJob: a job that a Slurm cluster runs. The hosts of the cluster mount the
// job's folder and the blobs under the same paths as this one.
//
//   TACTUS_ASSIGN_OR_RETURN(auto run, SlurmJob::Start(options, folder));
//   v1::JobEvent event;
//   while (run->Next(timeout, &event) != JobRun::News::kClosed) Use(event);
//   const JobRun::End end = run->Wait(patience);
//
// The batch script runs tactus-trainer, whose events go to the file "events.N"
// of the folder; N is how often Slurm has started the script. If Slurm requeues
// it, after a node has failed or for a more urgent job, it goes on from its
// checkpoints. The file "slurm" has Slurm's number, so that whoever starts the
// job again first cancels what may still run of it.
//
// Slurm is asked by its programs. While it does not answer, the job is taken to
// run. Not thread-safe, except Terminate.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "server/jobs/command.h"
#include "server/jobs/event_bytes.h"
#include "server/jobs/job_process.h"
#include "server/jobs/job_run.h"

namespace tactus::internal::server {

// How a job stands by what `scontrol show job` prints.
struct SlurmState {
  // Slurm has not begun to run it.
  bool waits = false;
  // It has ended; `end` says how.
  bool ended = false;
  JobRun::End end = {};
};
SlurmState ParseSlurmState(absl::string_view text);

class SlurmJob final : public JobRun {
 public:
  struct Options {
    // The program, its memory and its threads.
    JobProcess::Options process = {};
    int ranks = 1;
    // More arguments of sbatch, such as --partition=long.
    std::vector<std::string> sbatch = {};
    // How often Slurm is asked.
    std::chrono::milliseconds interval{2'000};
  };

  // Submits the job, after what an earlier call has submitted for this folder
  // has ended. IO, with what Slurm says.
  static absl::StatusOr<std::unique_ptr<SlurmJob>> Start(
      const Options& options, const std::string& folder);

  News Next(std::chrono::milliseconds timeout, v1::JobEvent* event) override;
  void Terminate(bool kill) override;
  End Wait(std::chrono::milliseconds patience) override;

  // Slurm's number of the job.
  const std::string& number() const { return number_; }

 private:
  SlurmJob(const Options& options, std::string folder, std::string number)
      : options_(options),
        folder_(std::move(folder)),
        number_(std::move(number)) {}
  // Asks Slurm, unless it was asked lately.
  void Ask();
  // Reads on in the files of events. False if there was nothing new.
  bool Read();

  const Options options_;
  const std::string folder_;
  const std::string number_;
  std::chrono::steady_clock::time_point asked_ = {};
  // When it was last asked to end, and whether at once.
  std::chrono::steady_clock::time_point terminated_ = {};
  bool killed_ = false;
  SlurmState state_;
  EventBytes bytes_;
  int starts_ = 0;
  int64_t at_ = 0;
};

}  // namespace tactus::internal::server
