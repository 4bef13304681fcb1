// File: find_max.h
//
// The largest number of robots that a server answers in time, by load tests of
// doubling and then halving steps.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const LoadReport most,
//       FindMaxRobots(options, {.p99_limit_ms = 10}, [](const auto&) {}));
//
// A free function without state.
#pragma once

#include <functional>

#include "absl/status/statusor.h"
#include "tools/load/load.h"

namespace tactus::internal::client {

struct FindMaxOptions {
  double p99_limit_ms = 10;
  // Where the search begins and ends.
  int min_robots = 25;
  int max_robots = 10'000;
  // It stops when the best and the first too many are this near, as a share.
  double precision = 0.04;
  // A number fails when so many tests in a row fail: one alone may be the doing
  // of something else on the machine. Doubling ends when two numbers in a row
  // fail, because what disturbs one may be over at the next.
  int attempts = 2;
};

// The report of the largest test that lost nothing and kept the limit; one of
// no robots if none did. The limit holds for 99 % of the answers, and for half
// of the last answers of streams: where few frames are answered, these show
// whether the server falls behind. `run` runs a test, `on_test` sees its
// report.
absl::StatusOr<LoadReport> FindMaxRobots(
    const FindMaxOptions& search,
    const std::function<absl::StatusOr<LoadReport>(int robots)>& run,
    const std::function<void(const LoadReport&)>& on_test);
// The same with tests of this process.
absl::StatusOr<LoadReport> FindMaxRobots(
    LoadOptions options, const FindMaxOptions& search,
    const std::function<void(const LoadReport&)>& on_test);

}  // namespace tactus::internal::client
