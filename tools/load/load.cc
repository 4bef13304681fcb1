#include "tools/load/load.h"

#include <memory>

#include "core/base/status_macros.h"
#include "tools/load/load_run.h"

namespace tactus::internal::client {

absl::StatusOr<FrameScript> MakeScript(const LoadOptions& options) {
  return FrameScript::Create({.seed = options.seed,
                              .frames_per_message = options.frames_per_message,
                              .sparse = options.sparse,
                              .untouched_seconds = options.untouched_seconds,
                              .touched_fraction = options.touched_fraction});
}

absl::StatusOr<LoadReport> RunLoad(const LoadOptions& options,
                                   const FrameScript& script) {
  TACTUS_RETURN_IF_ERROR(LoadRun::Check(options));
  const auto run = std::make_unique<LoadRun>(options, script);
  TACTUS_RETURN_IF_ERROR(run->Open());
  return ReportOf(run->Send(LoadClockNs() + LoadRun::kLeadNs));
}

absl::StatusOr<LoadReport> RunLoad(const LoadOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(const FrameScript script, MakeScript(options));
  return RunLoad(options, script);
}

}  // namespace tactus::internal::client
