// File: job.h
//
// A job as tactus-trainer runs it: reads its trials from the blobs, trains or
// evaluates, and leaves the outcome in the job's folder. Bundles that are not
// built in are blobs, too.
//
//   job.pb             the request (JobSpec), written by the server
//   candidate.tactus   the bundle to evaluate, if it is built in
//   current.tactus     the bundle to compare it with, if it is built in
//   parts/             checkpoints of a training
//   bundle.tactus      the trained model
//   result.pb          the outcome (JobOutcome), written last
//
//   const absl::Status status =
//       RunJob(files, folder, {.start = OnThreads(2), .run = OnThreads(1)},
//              &events, &journal, team);
//
// Not thread-safe: one job per process.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "core/store/file_system.h"
#include "server/trainer/event_writer.h"
#include "server/trainer/file_journal.h"
#include "server/trainer/team.h"

namespace tactus::internal::server {

// The threads that a job borrows: until the first iteration of a training, or
// until an evaluation has read its trials, and then.
struct JobThreads {
  ParallelFor start;
  ParallelFor run;
};

// Runs the job of a folder. An error of the job itself, such as unfit data, is
// an outcome too: the result is OK when an outcome was written. All ranks of a
// team must call it; they share out a training, and the first one writes the
// outcome.
absl::Status RunJob(FileSystem& files, const std::string& folder,
                    const JobThreads& threads, EventWriter* events,
                    FileJournal* journal, Team& team);

}  // namespace tactus::internal::server
