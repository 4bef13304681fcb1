// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <string>
#include <vector>

#include "core/base/status_macros.h"
#include "core/sim/coupled/coupled.h"
#include "core/sim/coupled/coupled_equations.h"
#include "core/sim/coupled/coupled_scene.h"
#include "core/sim/coupled/press_together.h"
#include "core/sim/exact/bounce.h"
#include "core/sim/exact/bounce_ride.h"
#include "core/sim/exact/bounce_series.h"
#include "core/sim/exact/contact_modes.h"
#include "core/sim/exact/contact_piece.h"
#include "core/sim/exact/damped_pair.h"
#include "core/sim/exact/exact.h"
#include "core/sim/exact/first_crossing.h"
#include "core/sim/exact/piece_signals.h"
#include "core/sim/exact/piece_sink.h"
#include "core/sim/exact/simulate_contact.h"
#include "core/sim/experiments/cody_set.h"
#include "core/sim/experiments/grid_set.h"
#include "core/sim/experiments/link_path.h"
#include "core/sim/experiments/paper_set.h"
#include "core/sim/experiments/random_scene.h"
#include "core/sim/experiments/random_world.h"
#include "core/sim/experiments/world_draws.h"
#include "core/sim/model/contact_phase.h"
#include "core/sim/model/equilibrium.h"
#include "core/sim/model/materials.h"
#include "core/sim/model/scene.h"
#include "core/sim/model/trajectory.h"
#include "core/sim/model/trial_spec.h"
#include "core/sim/skin/block_filter.h"
#include "core/sim/skin/butterworth.h"
#include "core/sim/skin/dent_kernels.h"
#include "core/sim/skin/line_contact.h"
#include "core/sim/skin/record_contact.h"
#include "core/sim/skin/record_contacts.h"
#include "core/sim/skin/signals.h"
#include "core/sim/skin/simulated_contact.h"
#include "core/sim/skin/skin_model.h"
#include "core/sim/skin/taxel_kernels.h"

namespace tactus::internal::examples {

static absl::Status CoupledExample(const CoupledScene& scene) {
#include "core/sim/coupled/coupled.h.inc"
  return absl::OkStatus();
}

static void CoupledEquationsExample(const CoupledScene& scene,
                                    const CoupledPhases& phases,
                                    const EquilibriumLeg& leg,
                                    const CoupledState& state) {
#include "core/sim/coupled/coupled_equations.h.inc"
}

static absl::Status CoupledSceneExample(const ContactScene& scene,
                                        const ContactScene& other) {
#include "core/sim/coupled/coupled_scene.h.inc"
  return absl::OkStatus();
}

static absl::Status PressTogetherExample(const TrialSpec& first,
                                         const TrialSpec& second) {
#include "core/sim/coupled/press_together.h.inc"
  return absl::OkStatus();
}

static void BounceExample(const ContactScene& scene, const ContactModes& modes,
                          const EquilibriumLeg& leg, ContactPhase phase,
                          double time, double until, const PieceState& state) {
  int changes_of_contact = 0;
#include "core/sim/exact/bounce.h.inc"
}

static void BounceRideExample(const BounceRide& ride, PieceSink& sink,
                              PhaseStart& next, PieceSummary& summary,
                              double time) {
#include "core/sim/exact/bounce_ride.h.inc"
}

static void BounceSeriesExample(
    const BounceChange& first_change,
    const BounceChange& change_of_the_bounce_after_the_stride) {
#include "core/sim/exact/bounce_series.h.inc"
}

static void ContactModesExample(const ContactScene& scene) {
#include "core/sim/exact/contact_modes.h.inc"
}

static void ContactPieceExample(const ContactScene& scene,
                                const ContactModes& modes,
                                const EquilibriumLeg& leg) {
#include "core/sim/exact/contact_piece.h.inc"
}

static void DampedPairExample() {
#include "core/sim/exact/damped_pair.h.inc"
}

static absl::Status ExactExample(const ContactScene& scene) {
#include "core/sim/exact/exact.h.inc"
  return absl::OkStatus();
}

static void FirstCrossingExample(const ContactPiece& piece) {
#include "core/sim/exact/first_crossing.h.inc"
}

static absl::Status PieceSignalsExample(const Cube& cube,
                                        const ContactScene& scene) {
#include "core/sim/exact/piece_signals.h.inc"
  return absl::OkStatus();
}

static absl::Status PieceSinkExample(const ContactScene& scene,
                                     PieceSink& sampler) {
#include "core/sim/exact/piece_sink.h.inc"
  return absl::OkStatus();
}

static absl::Status CodySetExample(const SkinLayout& layout,
                                   const SkinModel& skin, uint64_t seed) {
#include "core/sim/experiments/cody_set.h.inc"
  return absl::OkStatus();
}

static void GridSetExample(uint64_t seed, const SimulatedContact& contact) {
#include "core/sim/experiments/grid_set.h.inc"
}

static absl::Status PaperSetExample(uint64_t seed) {
  std::vector<Trial> trials;
#include "core/sim/experiments/paper_set.h.inc"
  return absl::OkStatus();
}

static absl::Status MaterialsExample(const std::string& csv_text) {
#include "core/sim/model/materials.h.inc"
  return absl::OkStatus();
}

static void RecordContactsExample(const SimulatedContact& first,
                                  const SimulatedContact& second,
                                  const Trial& metadata, const SkinModel& skin,
                                  const LinkMotion& motion, Random& random) {
#include "core/sim/skin/record_contacts.h.inc"
}

static void EquilibriumExample(const ContactScene& scene) {
#include "core/sim/model/equilibrium.h.inc"
}

static absl::Status SceneExample() {
#include "core/sim/model/scene.h.inc"
  return absl::OkStatus();
}

static void BlockFilterExample(const BlockFilter::Inputs& inputs) {
#include "core/sim/skin/block_filter.h.inc"
}

static void ButterworthExample(const std::vector<double>& samples) {
  std::vector<double> filtered;
#include "core/sim/skin/butterworth.h.inc"
}

static void SignalsExample(const Cube& cube, double force,
                           IdealSignals& signals, Random& random) {
#include "core/sim/skin/signals.h.inc"
}

static absl::Status SimulateContactExample(const TrialSpec& spec,
                                           uint64_t seed) {
#include "core/sim/exact/simulate_contact.h.inc"
  return absl::OkStatus();
}

static absl::Status SimulatedContactExample(const TrialSpec& spec,
                                            uint64_t seed) {
#include "core/sim/skin/simulated_contact.h.inc"
  return absl::OkStatus();
}

static void TrialSpecExample() {
#include "core/sim/model/trial_spec.h.inc"
}

static void TrajectoryExample(const Trajectory& trajectory, size_t i) {
#include "core/sim/model/trajectory.h.inc"
}

static void ContactPhaseExample(ContactPhase phase) {
#include "core/sim/model/contact_phase.h.inc"
}

static void DentKernelsExample(const std::vector<double>& places,
                               const std::vector<double>& widths,
                               std::vector<double>& volumes,
                               std::vector<double>& areas) {
#include "core/sim/skin/dent_kernels.h.inc"
}

static void LineContactExample(const SkinLayout& layout) {
#include "core/sim/skin/line_contact.h.inc"
}

static absl::Status SkinModelExample() {
#include "core/sim/skin/skin_model.h.inc"
  return absl::OkStatus();
}

static absl::Status RecordContactExample(const SimulatedContact& contact,
                                         uint64_t seed) {
  int never_felt = 0;
#include "core/sim/skin/record_contact.h.inc"
  return absl::OkStatus();
}

static void LinkPathExample(const SkinModel& skin, const PlacedContact& first,
                            const PlacedContact& second,
                            size_t last_frame_of_first,
                            size_t last_frame_of_second, size_t frames,
                            LinkMotion& motion) {
#include "core/sim/experiments/link_path.h.inc"
}

static absl::Status RandomSceneExample(const SkinModel& skin, uint64_t seed,
                                       uint64_t number) {
#include "core/sim/experiments/random_scene.h.inc"
  return absl::OkStatus();
}

static void WorldDrawsExample(Random& random) {
#include "core/sim/experiments/world_draws.h.inc"
}

static absl::Status RandomWorldExample(const SkinModel& skin, uint64_t seed) {
#include "core/sim/experiments/random_world.h.inc"
  return absl::OkStatus();
}

static void TaxelKernelsExample(const std::vector<double>& forces,
                                const taxel_kernels::TaxelState& state,
                                std::vector<double>& readings,
                                std::vector<uint16_t>& steps) {
#include "core/sim/skin/taxel_kernels.h.inc"
}

}  // namespace tactus::internal::examples
