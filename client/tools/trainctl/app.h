// File: app.h
//
// trainctl as a function, for main() and for tests.
//
//   return RunTrainctl(argc, argv);
//
// Not thread-safe.
#pragma once

namespace tactus::client {

// Runs one command line. Returns the exit code (exit_code.h).
int RunTrainctl(int argc, char** argv);

}  // namespace tactus::client
