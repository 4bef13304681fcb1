#include "client/trainctl/reproduce_data.h"

#include <functional>
#include <optional>
#include <utility>

#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/sim/paper_set.h"

namespace tactus::client {
namespace {

// The trials of one base contact.
using Job = std::function<absl::StatusOr<std::vector<Trial>>()>;

std::vector<Job> SimulationJobs(uint64_t seed) {
  std::vector<Job> jobs;
  for (const TrialSpec& spec : TrialSpecs(PaperConditions())) {
    jobs.push_back([spec, seed]() -> absl::StatusOr<std::vector<Trial>> {
      std::vector<Trial> trials;
      TACTUS_RETURN_IF_ERROR(
          ForEachContact({&spec, 1}, {}, [&](const SimulatedContact& contact) {
            trials.push_back(SignalTrial(contact, {}, seed));
            return absl::OkStatus();
          }));
      return trials;
    });
  }
  return jobs;
}

absl::StatusOr<std::vector<Job>> MakeJobs(Experiment experiment,
                                          uint64_t seed) {
  if (experiment == Experiment::kSimulation) return SimulationJobs(seed);
  return InvalidConfig("experiment", SourceOf(experiment).name,
                       "simulation; this release cannot simulate the robot");
}

}  // namespace

absl::StatusOr<LoadedContacts> SimulateExperiment(Experiment experiment,
                                                  uint64_t seed) {
  TACTUS_ASSIGN_OR_RETURN(const std::vector<Job> jobs,
                          MakeJobs(experiment, seed));
  using Extracted = std::vector<std::optional<Contact>>;
  std::vector<absl::StatusOr<Extracted>> results(jobs.size());
  RunOnThreads(static_cast<int>(jobs.size()), [&](int i) {
    results[i] = [&]() -> absl::StatusOr<Extracted> {
      TACTUS_ASSIGN_OR_RETURN(const std::vector<Trial> trials, jobs[i]());
      Extracted extracted;
      for (const Trial& trial : trials) {
        TACTUS_ASSIGN_OR_RETURN(auto contact, ExtractContact(trial));
        extracted.push_back(std::move(contact));
      }
      return extracted;
    }();
  });
  LoadedContacts data;
  for (auto& result : results) {
    TACTUS_RETURN_IF_ERROR(result.status());
    for (std::optional<Contact>& contact : *result) {
      ++data.trials;
      if (contact) {
        data.contacts.push_back(*std::move(contact));
      } else {
        ++data.undetectable;
      }
    }
  }
  return data;
}

}  // namespace tactus::client
