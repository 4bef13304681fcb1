#include "tools/load/find_max.h"

#include <algorithm>
#include <optional>

#include "core/base/status_macros.h"

namespace tactus::internal::client {

namespace {

class Search {
 public:
  Search(const FindMaxOptions& options,
         const std::function<absl::StatusOr<LoadReport>(int robots)>& run,
         const std::function<void(const LoadReport&)>& on_test)
      : options_(options), run_(run), on_test_(on_test) {}

  absl::StatusOr<LoadReport> Run() {
    TACTUS_RETURN_IF_ERROR(Double());
    TACTUS_RETURN_IF_ERROR(Halve());
    return best_;
  }

 private:
  // True if one of a few tests passes.
  absl::StatusOr<bool> Passes(int robots) {
    for (int i = 0; i < options_.attempts; ++i) {
      TACTUS_ASSIGN_OR_RETURN(const LoadReport report, run_(robots));
      on_test_(report);
      if (report.ok() && report.p99_ms <= options_.p99_limit_ms &&
          report.final_p50_ms <= options_.p99_limit_ms) {
        best_ = report;
        return true;
      }
    }
    return false;
  }

  absl::Status Double() {
    int robots = options_.min_robots;
    for (int failed = 0; failed < 2;) {
      TACTUS_ASSIGN_OR_RETURN(const bool passed, Passes(robots));
      failed = passed ? 0 : failed + 1;
      if (passed) {
        too_many_.reset();
      } else if (!too_many_) {
        too_many_ = robots;
      }
      if (robots >= options_.max_robots) break;
      robots = std::min(2 * robots, options_.max_robots);
    }
    return absl::OkStatus();
  }

  absl::Status Halve() {
    while (too_many_) {
      const int gap = *too_many_ - best_.robots;
      if (gap <= std::max(1.0, options_.precision * best_.robots)) break;
      const int robots = best_.robots + gap / 2;
      TACTUS_ASSIGN_OR_RETURN(const bool passed, Passes(robots));
      if (!passed) too_many_ = robots;
    }
    return absl::OkStatus();
  }

  const FindMaxOptions& options_;
  const std::function<absl::StatusOr<LoadReport>(int robots)>& run_;
  const std::function<void(const LoadReport&)>& on_test_;
  LoadReport best_;
  // The fewest above the best that were too many.
  std::optional<int> too_many_;
};

}  // namespace

absl::StatusOr<LoadReport> FindMaxRobots(
    const FindMaxOptions& search,
    const std::function<absl::StatusOr<LoadReport>(int robots)>& run,
    const std::function<void(const LoadReport&)>& on_test) {
  return Search(search, run, on_test).Run();
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
