// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <string>
#include <vector>

#include "core/base/status_macros.h"
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
#include "core/sim/experiments/paper_set.h"
#include "core/sim/experiments/random_world.h"
#include "core/sim/model/contact_phase.h"
#include "core/sim/model/materials.h"
#include "core/sim/model/scene.h"
#include "core/sim/model/trajectory.h"
#include "core/sim/model/trial_spec.h"
#include "core/sim/skin/block_filter.h"
#include "core/sim/skin/butterworth.h"
#include "core/sim/skin/dent_kernels.h"
#include "core/sim/skin/line_contact.h"
#include "core/sim/skin/record_contact.h"
#include "core/sim/skin/signals.h"
#include "core/sim/skin/simulated_contact.h"
#include "core/sim/skin/skin_model.h"
#include "core/sim/skin/taxel_kernels.h"

namespace tactus::examples {

void BounceExample(const ContactScene& scene, const ContactModes& modes,
                   bool ramping, ContactPhase phase, double time, double until,
                   const PieceState& state) {
  int changes_of_contact = 0;
  BounceTrain train(scene, modes, ramping);
  BounceMoment moment = train.MomentOf(phase, time, state);
  while (train.Next(until, moment) > 0) ++changes_of_contact;
}

void BounceRideExample(const BounceRide& ride, PieceSink& sink,
                       PhaseStart& next, PieceSummary& summary, double time) {
  time = RideBounces(ride, time, sink, next, summary);
}

void BounceSeriesExample(
    const BounceChange& first_change,
    const BounceChange& change_of_the_bounce_after_the_stride) {
  BounceSeries series(first_change);
  BounceChange change = series.Sum(0.5);  // of the next stride / 2 bounces
  series.Add(change_of_the_bounce_after_the_stride);
}

void ContactModesExample(const ContactScene& scene) {
  ContactModes modes(scene);
  modes.fast.fastest();
}

void ContactPieceExample(const ContactScene& scene, const ContactModes& modes) {
  ContactPiece piece(scene, modes, ContactPhase::kStuck, /*ramping=*/true,
                     /*begin=*/0, {});
  PieceState later = piece.At(0.01);
}

void DampedPairExample() {
  DampedPair pair(/*damping=*/2 * 21.6, /*stiffness=*/465);
  PairState later = pair.After({0.001, 0}, 0.02);
}

absl::Status ExactExample(const ContactScene& scene) {
  TACTUS_ASSIGN_OR_RETURN(Trajectory run, IntegrateExact(scene, {}));
  return absl::OkStatus();
}

void FirstCrossingExample(const ContactPiece& piece) {
  ModalFunction deformation = piece.Deformation();
  double lost = FirstCrossing(deformation, /*horizon=*/0.5);
}

absl::Status PieceSignalsExample(const Cube& cube, const ContactScene& scene) {
  PieceSignals reader(cube, scene, /*area=*/true);
  TACTUS_RETURN_IF_ERROR(SolvePieces(scene, {}, reader).status());
  IdealSignals signals = reader.Finish();
  return absl::OkStatus();
}

absl::Status PieceSinkExample(const ContactScene& scene, PieceSink& sampler) {
  TACTUS_RETURN_IF_ERROR(SolvePieces(scene, {}, sampler).status());
  return absl::OkStatus();
}

absl::Status CodySetExample(const SkinLayout& layout, const SkinModel& skin,
                            uint64_t seed) {
  for (const CodySpec& spec : CodySpecs(layout, seed)) {
    TACTUS_ASSIGN_OR_RETURN(auto contact, SimulateContact(spec.contact));
    TACTUS_ASSIGN_OR_RETURN(Trial trial,
                            CodySkinTrial(spec, contact, skin, seed));
  }
  return absl::OkStatus();
}

void GridSetExample(uint64_t seed, const SimulatedContact& contact) {
  const auto specs = DrawSpecs(UntrainedGrid().Conditions(), seed);
  Trial trial = contact.Metadata();
  trial.condition = ConditionName(contact.spec.robot);
}

absl::Status PaperSetExample(uint64_t seed) {
  std::vector<Trial> trials;
  for (const TrialSpec& spec : TrialSpecs(PaperGrid().Conditions())) {
    TACTUS_ASSIGN_OR_RETURN(const auto contacts, SimulateWithTwin(spec));
    for (const SimulatedContact& contact : contacts) {
      trials.push_back(SignalTrial(contact, {}, seed));
    }
  }
  return absl::OkStatus();
}

absl::Status MaterialsExample(const std::string& csv_text) {
  TACTUS_ASSIGN_OR_RETURN(auto more, ParseMaterials(csv_text));
  Cube cube = {more[0], /*edge_m=*/0.05, Surface::kGlass};
  return absl::OkStatus();
}

absl::Status SceneExample() {
  ContactScene scene;
  scene.goal_m = 0.019;
  TACTUS_RETURN_IF_ERROR(Validate(scene));
  return absl::OkStatus();
}

void BlockFilterExample(const BlockFilter::Inputs& inputs) {
  const BlockFilter& filter = BlockFilter::AntiAlias();
  BlockFilter::Column state = {};
  state = filter.Step(state, inputs);  // 20 inputs
  double output = BlockFilter::Output(state);
}

void ButterworthExample(const std::vector<double>& samples) {
  std::vector<double> filtered;
  Butterworth6 filter(200, 2000);
  for (double sample : samples) filtered.push_back(filter.Step(sample));
}

void SignalsExample(const Cube& cube, double force, IdealSignals& signals,
                    Random& random) {
  const double area = ContactArea(cube, force);
  AddNoise(SignalNoise(), random, signals.samples);
}

absl::Status SimulateContactExample(const TrialSpec& spec, uint64_t seed) {
  TACTUS_ASSIGN_OR_RETURN(const SimulatedContact contact,
                          SimulateContact(spec));
  Trial trial = SignalTrial(contact, SignalNoise(), seed);
  return absl::OkStatus();
}

absl::Status SimulatedContactExample(const TrialSpec& spec, uint64_t seed) {
  TACTUS_ASSIGN_OR_RETURN(auto contact, SimulateContact(spec));
  Trial trial = SignalTrial(contact, SignalNoise(), seed);
  return absl::OkStatus();
}

void TrialSpecExample() {
  TrialSpec spec;
  spec.object = {Materials()[0], 0.05, Surface::kWood};
  spec.robot = {.stiffness = 543, .velocity = 0.005};
  ContactScene scene = SceneOf(spec);
}

void TrajectoryExample(const Trajectory& trajectory, size_t i) {
  const TrajectorySample& sample = trajectory.samples[i];
  const double time = i / trajectory.sample_rate_hz;
}

void ContactPhaseExample(ContactPhase phase) {
  const bool touching = Touching(phase);
  if (touching && !Sliding(phase)) return;  // kStuck
}

void DentKernelsExample(const std::vector<double>& places,
                        const std::vector<double>& widths,
                        std::vector<double>& volumes,
                        std::vector<double>& areas) {
  dent_kernels::Cut({.depth = 0.001, .low = -0.02, .high = 0.02}, places,
                    widths.data(), volumes.data(), areas.data());
}

void LineContactExample(const SkinLayout& layout) {
  LineContact contact(layout, {.row = 7.5, .column = 3});
  contact.Press(2.5, {.edge_m = 0.04, .bedding_n_m3 = 1e7});
  const double newton = contact.taxels()[7 * layout.columns + 3];
}

absl::Status SkinModelExample() {
  TACTUS_ASSIGN_OR_RETURN(const SkinModel skin, SkinModelNamed("good"));
  return absl::OkStatus();
}

absl::Status RecordContactExample(const SimulatedContact& contact,
                                  uint64_t seed) {
  int undetectable = 0;
  TACTUS_ASSIGN_OR_RETURN(const SkinModel skin, SkinModelNamed("good"));
  Random random = Random::ForStream(seed, contact.spec.number);
  const Placement placement = DrawPlacement(skin.layout, random);
  Trial trial = RecordContact(contact, skin, placement, random);
  if (!Detectable(trial, skin.layout)) ++undetectable;
  return absl::OkStatus();
}

absl::Status RandomWorldExample(const SkinModel& skin, uint64_t seed) {
  for (uint64_t n = 0; n < 100'000; ++n) {
    TACTUS_ASSIGN_OR_RETURN(Trial trial, WorldTrial(skin, seed, n));
  }
  return absl::OkStatus();
}

void TaxelKernelsExample(const std::vector<double>& forces,
                         const taxel_kernels::TaxelState& state,
                         std::vector<double>& readings,
                         std::vector<uint16_t>& steps) {
  taxel_kernels::Read(forces, {.noise_n = 0.002}, state, readings.data());
  taxel_kernels::Quantise(readings, /*step=*/0.001, steps.data());
}

}  // namespace tactus::examples
