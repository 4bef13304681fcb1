#include "tests/bench/rendered_frames.h"

#include "core/base/status_macros.h"
#include "core/sim/exact/simulate_contact.h"
#include "core/sim/experiments/paper_set.h"
#include "core/sim/skin/record_contact.h"

namespace tactus::client {

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

}  // namespace tactus::client
