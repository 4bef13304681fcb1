// File: trainer_main.h
//
// The program tactus-trainer, as one process or as several ranks.
//
//   LoneTeam alone;
//   return TrainerMain(argc, argv, alone);
//
// Takes signals and the handler of uncaught errors: one call in a process.
#pragma once

#include "server/trainer/team.h"

namespace tactus::internal::server {

// Runs the job that the arguments name, and returns the exit status
// (exit_status.h).
int TrainerMain(int argc, char** argv, Team& team);

}  // namespace tactus::internal::server
