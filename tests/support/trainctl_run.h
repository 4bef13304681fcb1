// File: trainctl_run.h
//
// Runs trainctl inside the test: the commands of the program that need no
// server, without a process. Test-only.
//
//   const TrainctlRun run = RunTrainctl("inspect " + path + " --json");
//   EXPECT_TRUE(run.status.ok()) << run.status;
//   Json::parse(run.out)["trials"];
//
// Captures stdout, so only one run at a time.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "gtest/gtest.h"
#include "tools/trainctl/verbs.h"

namespace tactus::internal::testing {

struct TrainctlRun {
  absl::Status status;
  std::string out;
};

// `arguments` as on the command line, without the program's name. Arguments
// that do not parse end the test with the parser's exception.
inline TrainctlRun RunTrainctl(const std::string& arguments) {
  CLI::App app;
  client::Command command;
  const client::SelectCommand select = [&](client::Command chosen) {
    command = std::move(chosen);
  };
#define TACTUS_VERB(verb) client::Add##verb(app, select);
#define TACTUS_SERVER_VERB(verb)
#define TACTUS_STAND_IN_VERB TACTUS_VERB
#include "tools/trainctl/verbs.inc"
#undef TACTUS_VERB
#undef TACTUS_SERVER_VERB
#undef TACTUS_STAND_IN_VERB
  app.parse(arguments);
  ::testing::internal::CaptureStdout();
  TrainctlRun run;
  run.status = command();
  run.out = ::testing::internal::GetCapturedStdout();
  return run;
}

}  // namespace tactus::internal::testing
