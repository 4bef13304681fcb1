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
// checkpoints. Its name in Slurm is made of the folder; whoever starts the job
// again finds by it what may still run, and cancels that first.
//
// Slurm is asked by its programs. While it does not answer, a job is submitted
// again, and one that was submitted is taken to run. Not thread-safe.
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

  // Submits the job. If Slurm does not answer, or what an earlier call has
  // submitted for this folder has not ended, `Next` does. IO, with what Slurm
  // says, if it refuses.
  static absl::StatusOr<std::unique_ptr<SlurmJob>> Start(
      const Options& options, const std::string& folder);

  News Next(std::chrono::milliseconds timeout, v1::JobEvent* event) override;
  void Terminate(bool kill) override;
  End Wait(std::chrono::milliseconds patience) override;

  // Slurm's number of the job; empty until Slurm has taken it.
  const std::string& number() const { return number_; }

 private:
  SlurmJob(const Options& options, std::string folder)
      : options_(options), folder_(std::move(folder)) {}
  // One try to give the job to Slurm. IO if Slurm refuses.
  absl::Status Submit();
  // Cancels what was submitted for the folder before; true once all of it has
  // ended.
  absl::StatusOr<bool> EndEarlier() const;
  void EndUnsubmitted(const std::string& text);
  // Asks Slurm how the job stands, or to take it, unless it was asked lately.
  void Ask();
  // Reads on in the files of events. False if there was nothing new.
  bool Read();

  const Options options_;
  const std::string folder_;
  std::string number_;
  // When Slurm was last asked.
  std::chrono::steady_clock::time_point tried_ = {};
  // When it was last asked to end, and whether at once.
  std::chrono::steady_clock::time_point terminated_ = {};
  bool killed_ = false;
  SlurmState state_;
  EventBytes bytes_;
  int starts_ = 0;
  int64_t at_ = 0;
};

}  // namespace tactus::internal::server
