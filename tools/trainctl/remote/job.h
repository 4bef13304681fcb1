// File: job.h
//
// What the commands that start or watch a job share: they follow it to its end,
// print it, and end as it did.
//
//   TACTUS_ASSIGN_OR_RETURN(const v1::Operation job,
//                           client.TrainModel(request));
//   return FollowJob(client, flags, job);
//
// Thread-safe, except that one job at a time can be followed.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "tactus/v1/operations.pb.h"
#include "tools/trainctl/remote/flags.h"

namespace tactus::internal::client {

// One line: name, kind, state, times, and what it is about.
std::string JobLine(const v1::Operation& job);
// What the job made, on several lines; empty if it made nothing.
std::string ResultText(const v1::Operation& job);

// Prints a job: JSON if the flags say so.
void PrintJob(const v1::Operation& job, const RemoteFlags& flags);

// OK if the job succeeded, else its error with the exit code that fits.
absl::Status StatusOfJob(const v1::Operation& job);

// Shows the job's progress until it ends and prints it. Ctrl-C ends the
// command and leaves the job running.
absl::Status FollowJob(TrainingClient& client, const RemoteFlags& flags,
                       const v1::Operation& job);

}  // namespace tactus::internal::client
