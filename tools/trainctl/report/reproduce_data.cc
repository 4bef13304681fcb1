#include "tools/trainctl/report/reproduce_data.h"

#include <optional>
#include <utility>
#include <vector>

#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/skin/layout.h"
#include "tools/trainctl/data/simulate_jobs.h"

namespace tactus::internal::client {
namespace {

using Extracted = std::vector<std::optional<LabelledContact>>;

// The flags of `trainctl simulate` for an experiment.
SimulateFlags FlagsOf(Experiment experiment, uint64_t seed,
                      const std::string& noise) {
  SimulateFlags flags;
  flags.seed = seed;
  if (experiment == Experiment::kCody) {
    flags.protocol = "cody";
    flags.skin = "good";
  } else {
    flags.noise = noise;
  }
  return flags;
}

absl::StatusOr<Extracted> Extract(const SimulateJobs& jobs, size_t number) {
  TACTUS_ASSIGN_OR_RETURN(const std::vector<SensedContact> sensed,
                          jobs.run(number));
  Extracted extracted;
  for (const SensedContact& each : sensed) {
    TACTUS_ASSIGN_OR_RETURN(auto contact, ExtractContact(each.trial));
    extracted.push_back(std::move(contact));
  }
  return extracted;
}

}  // namespace

absl::StatusOr<LoadedContacts> SimulateExperiment(Experiment experiment,
                                                  uint64_t seed,
                                                  const std::string& noise,
                                                  const Progress& progress) {
  const SimulateFlags flags = FlagsOf(experiment, seed, noise);
  TACTUS_ASSIGN_OR_RETURN(const SkinLayout layout, LayoutOf(flags));
  TACTUS_ASSIGN_OR_RETURN(const SimulateJobs jobs, MakeJobs(flags, layout));
  std::vector<absl::StatusOr<Extracted>> results(jobs.count);
  RunOnThreads(static_cast<int>(jobs.count), [&](int i) {
    results[i] = Extract(jobs, i);
    progress.Add(1 / static_cast<double>(jobs.count));
  });
  LoadedContacts data;
  for (auto& result : results) {
    TACTUS_RETURN_IF_ERROR(result.status());
    for (std::optional<LabelledContact>& contact : *result) {
      ++data.trials;
      if (contact) {
        data.contacts.push_back(*std::move(contact));
      } else {
        ++data.never_felt;
      }
    }
  }
  return data;
}

}  // namespace tactus::internal::client
