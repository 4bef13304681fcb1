#include "tests/bench/rendered_frames.h"

#include "core/base/status_macros.h"
#include "core/features/contact_tracker.h"
#include "core/sim/exact/simulate_contact.h"
#include "core/sim/experiments/paper_set.h"
#include "core/sim/experiments/random_world.h"
#include "core/sim/skin/record_contact.h"

namespace tactus::client {
namespace {

// Seed of the built-in models' test contacts (research/results/world.md).
constexpr uint64_t kWorldSeed = 1001;

}  // namespace

absl::StatusOr<std::vector<RenderedTrial>> RenderTrials(const SkinModel& skin,
                                                        int count) {
  const std::vector<TrialSpec> specs = TrialSpecs(PaperGrid().Conditions());
  std::vector<RenderedTrial> trials;
  // Prime, so that steps meet every material and size.
  constexpr size_t kStride = 101;
  for (size_t i = kStride; static_cast<int>(trials.size()) < count;
       i = (i + kStride) % specs.size()) {
    TACTUS_ASSIGN_OR_RETURN(const auto contact, SimulateContact(specs[i]));
    Random random = Random::ForStream(/*seed=*/1, contact.spec.number);
    const Placement placement = DrawPlacement(skin.layout, random);
    const Trial trial = RecordContact(contact, skin, placement, random);
    if (!Detectable(trial, skin.layout)) continue;
    RenderedTrial& to = trials.emplace_back();
    to.taxels = skin.layout.taxels();
    to.lead_in = placement.lead_in_frames;
    to.poses = trial.poses;
    to.values.resize(trial.taxels.frames() * to.taxels);
    for (size_t t = 0; t < trial.taxels.frames(); ++t) {
      trial.taxels.Decode(t, &to.values[t * to.taxels]);
    }
  }
  return trials;
}

absl::StatusOr<std::vector<RenderedTrial>> WorldTrials(const SkinModel& skin,
                                                       int count) {
  std::vector<RenderedTrial> trials;
  for (uint64_t n = 0; static_cast<int>(trials.size()) < count; ++n) {
    TACTUS_ASSIGN_OR_RETURN(const Trial trial, WorldTrial(skin, kWorldSeed, n));
    ContactTracker tracker(skin.layout, {.release_after_s = -1});
    RenderedTrial to;
    to.taxels = skin.layout.taxels();
    to.poses = trial.poses;
    to.lead_in = to.frames();
    to.values.resize(trial.taxels.frames() * to.taxels);
    for (int t = 0; t < to.frames(); ++t) {
      trial.taxels.Decode(t, &to.values[size_t(t) * to.taxels]);
      tracker.Step(to.frame(t));
      if (tracker.onset()) to.lead_in = t;
    }
    if (to.lead_in < to.frames()) trials.push_back(std::move(to));
  }
  return trials;
}

}  // namespace tactus::client
