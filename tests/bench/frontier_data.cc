#include "tests/bench/frontier_data.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "client/tools/trainctl/command.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/sim/experiments/grid_set.h"

namespace tactus::client {
namespace {

constexpr size_t kTestContacts = 400;
constexpr size_t kQuickTestContacts = 60;
// Of the paper's trials, every one of this many; even over the conditions, and
// over materials as it does not divide their number.
constexpr size_t kQuickStride = 27;

std::vector<TrialSpec> AllGridSpecs() {
  const Grid grid;
  return DrawSpecs(
      GridConditions(grid.stiffnesses, grid.velocities, grid.goals), kTestSeed);
}

using Pair = std::vector<LabelledContact>;

// A contact and the twin of one that moved.
absl::StatusOr<Pair> SimulatePair(const TrialSpec& spec, uint64_t seed) {
  Pair pair;
  for (const TrialSpec& each : {spec, FixedTwin(spec)}) {
    TACTUS_ASSIGN_OR_RETURN(const SimulatedContact simulated,
                            SimulateContact(each));
    TACTUS_ASSIGN_OR_RETURN(pair.emplace_back(), ContactOf(simulated, seed));
    if (!simulated.moved) break;
  }
  return pair;
}

absl::StatusOr<std::vector<LabelledContact>> Simulate(
    std::span<const TrialSpec> specs, uint64_t seed) {
  std::vector<absl::StatusOr<Pair>> pairs(specs.size());
  RunOnThreads(static_cast<int>(specs.size()),
               [&](int i) { pairs[i] = SimulatePair(specs[i], seed); });
  std::vector<LabelledContact> contacts;
  for (absl::StatusOr<Pair>& pair : pairs) {
    TACTUS_RETURN_IF_ERROR(pair.status());
    std::ranges::move(*pair, std::back_inserter(contacts));
  }
  return contacts;
}

}  // namespace

std::vector<const LabelledContact*> Pointers(
    const std::vector<LabelledContact>& contacts) {
  std::vector<const LabelledContact*> pointers;
  for (const LabelledContact& contact : contacts) pointers.push_back(&contact);
  return pointers;
}

absl::StatusOr<LabelledContact> ContactOf(const SimulatedContact& simulated,
                                          uint64_t seed) {
  TACTUS_ASSIGN_OR_RETURN(
      std::optional<LabelledContact> contact,
      ExtractContact(SignalTrial(simulated, SignalNoise(), seed)));
  if (!contact) return NumericalFailure("a simulated contact touches nothing");
  return *std::move(contact);
}

absl::StatusOr<FrontierData> MakeFrontierData(bool quick) {
  std::vector<TrialSpec> training = TrialSpecs(PaperConditions());
  if (quick) {
    std::vector<TrialSpec> some;
    for (size_t i = 0; i < training.size(); i += kQuickStride) {
      some.push_back(training[i]);
    }
    training = some;
  }
  FrontierData data;
  TACTUS_ASSIGN_OR_RETURN(data.training, Simulate(training, kTrainingSeed));
  const size_t wanted = quick ? kQuickTestContacts : kTestContacts;
  const std::vector<TrialSpec> test = AllGridSpecs();
  TACTUS_ASSIGN_OR_RETURN(data.test,
                          Simulate(std::span(test).first(wanted), kTestSeed));
  data.test.resize(wanted);
  return data;
}

std::vector<TrialSpec> GridSpecs(int count) {
  std::vector<TrialSpec> specs = AllGridSpecs();
  specs.resize(count);
  for (size_t i = 1; i < specs.size(); i += 2) specs[i] = FixedTwin(specs[i]);
  return specs;
}

}  // namespace tactus::client
