// File: trainctl_program.h
//
// Runs the whole of trainctl inside the test, from the command line to the exit
// code. Test-only.
//
//   const Outcome outcome = Trainctl({"datasets", "list"});
//   EXPECT_EQ(outcome.exit, 0) << outcome.err;
//
// Captures stdout and stderr, so only one run at a time.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "gtest/gtest.h"
#include "tools/common/json.h"
#include "tools/trainctl/app.h"

namespace tactus::internal::client::testing {

struct Outcome {
  int exit = -1;
  std::string out;
  std::string err;

  Json json() const { return Json::parse(out); }
};

inline Outcome Trainctl(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "trainctl");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  Outcome outcome;
  outcome.exit = RunTrainctl(static_cast<int>(argv.size()), argv.data());
  outcome.out = ::testing::internal::GetCapturedStdout();
  outcome.err = ::testing::internal::GetCapturedStderr();
  return outcome;
}

}  // namespace tactus::internal::client::testing
