#include "tests/bench/rendered_frames.h"

#include "core/base/status_macros.h"
#include "core/features/contact_tracker.h"
#include "core/sim/exact/simulate_contact.h"
#include "core/sim/experiments/paper_set.h"
#include "core/sim/experiments/random_world.h"
#include "core/sim/skin/record_contact.h"
#include "core/sim/skin/record_contacts.h"

namespace tactus::internal::client {
namespace {

// Seed of the built-in models' test contacts (research/results/world.md).
constexpr uint64_t kWorldSeed = 1001;

// Frames of idle skin before objects are pressed, and pressed ones until all
// are contacts.
constexpr int kIdleFrames = 100;
constexpr int kBeginFrames = 50;

// The frames of a trial whose lead-in is still unknown.
RenderedTrial Decoded(const Trial& trial, const SkinLayout& layout) {
  RenderedTrial to;
  to.taxels = layout.taxels();
  to.poses = trial.poses;
  to.values.resize(trial.taxels.frames() * to.taxels);
  for (size_t t = 0; t < trial.taxels.frames(); ++t) {
    trial.taxels.Decode(t, &to.values[t * to.taxels]);
  }
  return to;
}

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
    trials.push_back(Decoded(trial, skin.layout));
    trials.back().lead_in = placement.lead_in_frames;
  }
  return trials;
}

absl::StatusOr<std::vector<RenderedTrial>> WorldTrials(const SkinModel& skin,
                                                       int count) {
  std::vector<RenderedTrial> trials;
  for (uint64_t n = 0; static_cast<int>(trials.size()) < count; ++n) {
    TACTUS_ASSIGN_OR_RETURN(const Trial trial, WorldTrial(skin, kWorldSeed, n));
    ContactTracker tracker(skin.layout, {.release_after_s = -1});
    RenderedTrial to = Decoded(trial, skin.layout);
    to.lead_in = to.frames();
    for (int t = 0; t < to.frames(); ++t) {
      tracker.Step(to.frame(t));
      if (tracker.onset()) to.lead_in = t;
    }
    if (to.lead_in < to.frames()) trials.push_back(std::move(to));
  }
  return trials;
}

absl::StatusOr<RenderedTrial> PressedTrial(const SkinModel& skin, int objects) {
  std::vector<SimulatedContact> contacts;
  for (int i = 0; i < objects; ++i) {
    TrialSpec spec;
    spec.object = {Materials()[i], 0.02, Surface::kWood};
    spec.fixed = true;
    TACTUS_ASSIGN_OR_RETURN(contacts.emplace_back(), SimulateContact(spec));
  }
  std::vector<PlacedContact> placed;
  for (int i = 0; i < objects; ++i) {
    placed.push_back({.contact = &contacts[i],
                      // Two rows of four.
                      .centre = {.row = i % 2 == 0 ? 3.5 : 11.5,
                                 .column = 2.0 + 6 * (i / 2)},
                      .begin_frame = kIdleFrames,
                      .end_sample = contacts[i].signals.samples.size()});
  }
  const LinkMotion still = {
      .steps = std::vector<LinkStep>(kIdleFrames +
                                     contacts[0].signals.samples.size()),
      .pose_noise_m = skin.pose_noise_min_m};
  Random random(/*seed=*/1);
  RenderedTrial trial = Decoded(
      RecordContacts(contacts[0].Metadata(), placed, skin, still, random),
      skin.layout);
  trial.lead_in = kIdleFrames + kBeginFrames;
  return trial;
}

}  // namespace tactus::internal::client
