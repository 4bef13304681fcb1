#include "tools/load/find_max.h"

#include <algorithm>
#include <optional>

#include "core/base/status_macros.h"

namespace tactus::internal::client {

absl::StatusOr<LoadReport> FindMaxRobots(
    const FindMaxOptions& search,
    const std::function<absl::StatusOr<LoadReport>(int robots)>& run,
    const std::function<void(const LoadReport&)>& on_test) {
  LoadReport best;
  // The fewest that were too many.
  std::optional<int> too_many;
  int robots = search.min_robots;
  while (true) {
    bool passed = false;
    for (int i = 0; i < search.attempts && !passed; ++i) {
      TACTUS_ASSIGN_OR_RETURN(const LoadReport report, run(robots));
      on_test(report);
      passed = report.ok() && report.p99_ms <= search.p99_limit_ms &&
               report.final_p50_ms <= search.p99_limit_ms;
      if (passed) best = report;
    }
    if (!passed) too_many = robots;
    if (passed && robots >= search.max_robots) return best;
    if (!too_many) {
      robots = std::min(2 * robots, search.max_robots);
      continue;
    }
    const int gap = *too_many - best.robots;
    if (gap <= std::max(1.0, search.precision * best.robots)) return best;
    robots = best.robots + gap / 2;
  }
}

absl::StatusOr<LoadReport> FindMaxRobots(
    LoadOptions options, const FindMaxOptions& search,
    const std::function<void(const LoadReport&)>& on_test) {
  TACTUS_ASSIGN_OR_RETURN(const FrameScript script, MakeScript(options));
  return FindMaxRobots(
      search,
      [&options, &script](int robots) {
        options.robots = robots;
        return RunLoad(options, script);
      },
      on_test);
}

}  // namespace tactus::internal::client
