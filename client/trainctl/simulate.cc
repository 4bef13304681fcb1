// trainctl simulate: the paper's experiment, as trials in a file.
#include <algorithm>
#include <iostream>
#include <optional>

#include "absl/strings/str_format.h"
#include "client/trainctl/command.h"
#include "client/trainctl/simulate_one.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/data/trial_file.h"
#include "core/sim/paper_set.h"
#include "core/sim/render.h"

namespace tactus::client {
namespace {

constexpr const char* kLabels[] = {"HU", "HM", "SU", "SM"};
// The paper's Section "Data Collection" of the simulated experiment.
constexpr int kPaperCounts[] = {544, 365, 496, 430};
// Contacts simulated before they are written, which bounds the memory.
constexpr size_t kBlock = 64;

struct Flags {
  std::string protocol = "paper";
  double goal_m = kPaperGoal;
  std::string sensor = "signals";
  uint64_t seed = 1;
  std::string out;
  std::vector<double> stiffnesses = {543, 2050};
  std::vector<double> velocities = {0.005, 0.02};
  RenderOptions render;
  bool json = false;
  OneContactFlags one;
};

struct Tally {
  int counts[4] = {};
  int undetectable = 0;
  int clamped = 0;

  int trials() const { return counts[0] + counts[1] + counts[2] + counts[3]; }
};

// A base contact and, if the object moved, its twin with the object fixed.
struct Pair {
  absl::Status status;
  std::vector<SimulatedContact> contacts;
  std::vector<Trial> trials;
};

class Simulation {
 public:
  Simulation(const Flags& flags, const SkinLayout& layout)
      : flags_(flags), layout_(layout) {}

  Pair Run(const TrialSpec& spec) const {
    Pair pair;
    pair.status = [&]() -> absl::Status {
      TACTUS_ASSIGN_OR_RETURN(auto contact, SimulateContact(spec));
      pair.contacts.push_back(std::move(contact));
      if (pair.contacts[0].moved) {
        TACTUS_ASSIGN_OR_RETURN(auto twin, SimulateContact(FixedTwin(spec)));
        pair.contacts.push_back(std::move(twin));
      }
      for (const SimulatedContact& each : pair.contacts) {
        TACTUS_ASSIGN_OR_RETURN(Trial trial, Sense(each));
        pair.trials.push_back(std::move(trial));
      }
      return absl::OkStatus();
    }();
    return pair;
  }

  bool Undetectable(const Trial& trial) const {
    return taxels() && !Detectable(trial, layout_);
  }

 private:
  bool taxels() const { return flags_.sensor == "taxels"; }

  absl::StatusOr<Trial> Sense(const SimulatedContact& contact) const {
    if (!taxels()) return SignalTrial(contact, SignalNoise(), flags_.seed);
    return TaxelTrial(contact, layout_, flags_.render, flags_.seed);
  }

  const Flags& flags_;
  const SkinLayout& layout_;
};

absl::Status CheckFlags(const Flags& flags) {
  if (flags.protocol != "paper") {
    return InvalidConfig("--protocol", flags.protocol, "paper");
  }
  if (flags.sensor != "signals" && flags.sensor != "taxels") {
    return InvalidConfig("--sensor", flags.sensor, "signals or taxels");
  }
  return absl::OkStatus();
}

std::vector<RobotCondition> Conditions(const Flags& flags) {
  std::vector<RobotCondition> conditions;
  for (double stiffness : flags.stiffnesses) {
    for (double velocity : flags.velocities) {
      conditions.push_back({stiffness, velocity, flags.goal_m});
    }
  }
  return conditions;
}

void Count(const Pair& pair, const Simulation& simulation, Tally& tally) {
  for (size_t i = 0; i < pair.contacts.size(); ++i) {
    const std::string label = pair.contacts[i].Label();
    const auto* found = std::find(kLabels, kLabels + 4, label);
    ++tally.counts[found - kLabels];
    tally.clamped += pair.contacts[i].signals.clamped > 0;
    tally.undetectable += simulation.Undetectable(pair.trials[i]);
  }
}

void Print(const Flags& flags, const Tally& tally) {
  if (flags.json) {
    Json counts;
    Json paper;
    for (int k = 0; k < 4; ++k) {
      counts[kLabels[k]] = tally.counts[k];
      paper[kLabels[k]] = kPaperCounts[k];
    }
    std::cout << Json{{"trials", tally.trials()},
                      {"counts", counts},
                      {"paper_counts", paper},
                      {"undetectable", tally.undetectable},
                      {"strain_clamped", tally.clamped},
                      {"sensor", flags.sensor},
                      {"goal_m", flags.goal_m},
                      {"seed", flags.seed},
                      {"seconds", SecondsSinceStart()}}
                     .dump()
              << "\n";
    return;
  }
  std::cout << "          HU    HM    SU    SM   total\n"
            << absl::StrFormat("here   %5d %5d %5d %5d   %5d\n",
                               tally.counts[0], tally.counts[1],
                               tally.counts[2], tally.counts[3], tally.trials())
            << absl::StrFormat("paper  %5d %5d %5d %5d   %5d\n",
                               kPaperCounts[0], kPaperCounts[1],
                               kPaperCounts[2], kPaperCounts[3], 1835)
            << absl::StrFormat(
                   "%d undetectable, %d with clamped strain, goal %g m, "
                   "sensor %s, seed %d, %.1f s\n",
                   tally.undetectable, tally.clamped, flags.goal_m,
                   flags.sensor, flags.seed, SecondsSinceStart());
}

absl::Status Run(const Flags& flags) {
  if (!flags.one.scene.empty()) return SimulateOne(flags.one, std::cout);
  TACTUS_RETURN_IF_ERROR(CheckFlags(flags));
  TACTUS_ASSIGN_OR_RETURN(const SkinLayout layout,
                          LayoutPreset("cody-forearm"));
  TACTUS_RETURN_IF_ERROR(Validate(flags.render, layout));
  std::optional<TrialFileWriter> writer;
  if (!flags.out.empty()) {
    TACTUS_ASSIGN_OR_RETURN(
        auto created, TrialFileWriter::Create(flags.out, {.overwrite = true}));
    writer.emplace(std::move(created));
  }
  const std::vector<TrialSpec> specs = TrialSpecs(Conditions(flags));
  const Simulation simulation(flags, layout);
  Tally tally;
  for (size_t begin = 0; begin < specs.size(); begin += kBlock) {
    const size_t size = std::min(kBlock, specs.size() - begin);
    std::vector<Pair> pairs(size);
    RunOnThreads(static_cast<int>(size),
                 [&](int i) { pairs[i] = simulation.Run(specs[begin + i]); });
    for (const Pair& pair : pairs) {
      TACTUS_RETURN_IF_ERROR(pair.status);
      Count(pair, simulation, tally);
      for (const Trial& trial : pair.trials) {
        if (writer) TACTUS_RETURN_IF_ERROR(writer->Append(trial));
      }
    }
  }
  if (writer) TACTUS_RETURN_IF_ERROR(writer->Close());
  Print(flags, tally);
  return absl::OkStatus();
}

}  // namespace

void AddSimulate(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<Flags>();
  CLI::App* command = app.add_subcommand(
      "simulate", "Simulate the paper's contacts into a trial file");
  command->add_option("--protocol", flags->protocol, "paper");
  command->add_option("--goal", flags->goal_m,
                      "Goal of the equilibrium point, m");
  command->add_option("--sensor", flags->sensor,
                      "signals (ideal) or taxels (rendered frames)");
  command->add_option("--seed", flags->seed, "Seed of place and noise");
  command->add_option("--out", flags->out, "Trial file to write");
  command
      ->add_option("--stiffness", flags->stiffnesses,
                   "Arm stiffnesses, N/m, instead of the paper's")
      ->delimiter(',');
  command
      ->add_option("--velocity", flags->velocities,
                   "Arm speeds, m/s, instead of the paper's")
      ->delimiter(',');
  command->add_option("--taxel-noise", flags->render.taxel_noise,
                      "Noise of a taxel, N");
  command->add_option("--taxel-step", flags->render.taxel_step,
                      "Quantisation of a taxel, N");
  command->add_option("--encoder-noise", flags->render.encoder_noise_m,
                      "Noise of the arm's position, m");
  command->add_option("--dead-taxels", flags->render.dead_count,
                      "Number of dead taxels");
  command->add_flag("--json", flags->json, "One JSON object on stdout");
  AddOneContactFlags(*command, flags->one);
  command->callback([=] { select([=] { return Run(*flags); }); });
}

}  // namespace tactus::client
