// File: app.h
//
// trainctl as a function, for main() and for tests.
//
//   return RunTrainctl(argc, argv);
//
// Not thread-safe.
#pragma once

#include "tools/trainctl/command.h"

namespace tactus::internal::client {

// Adds all commands of the program to `app`.
void AddCommands(CLI::App& app, const SelectCommand& select);

// Runs one command line. Returns the exit code (exit_code.h).
int RunTrainctl(int argc, char** argv);

}  // namespace tactus::internal::client
