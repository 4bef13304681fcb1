// trainctl simulate: writes contacts of a simulated arm to a trial file.
#include <algorithm>
#include <iostream>
#include <limits>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/data/trial_file.h"
#include "core/sim/experiments/paper_set.h"
#include "core/sim/skin/record_contact.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/data/simulate_jobs.h"
#include "tools/trainctl/data/simulate_one.h"
#include "tools/trainctl/progress_display.h"

namespace tactus::internal::client {
namespace {

constexpr const char* kLabels[] = {"HU", "HM", "SU", "SM"};
// Jobs that are simulated before their contacts are written. Bounds the memory.
constexpr size_t kBlock = 64;

// The counts of the paper, for the protocols that it has too.
struct PaperCounts {
  const char* protocol;
  int counts[4];
};
constexpr PaperCounts kPaperCounts[] = {
    // Section "Data Collection" of the simulated experiment.
    {"paper", {544, 365, 496, 430}},
    // The same of the robot experiment: "Each object category had 60 trials".
    {"cody", {60, 60, 60, 60}},
};

int Sum(const int (&counts)[4]) {
  return counts[0] + counts[1] + counts[2] + counts[3];
}

struct Tally {
  int trials = 0;
  // Over all contacts of the trials.
  int counts[4] = {};
  int never_felt = 0;
  int clamped = 0;
};

void Count(const SensedContact& contact, const SimulateFlags& flags,
           const SkinLayout& layout, Tally& tally) {
  const auto count = [&tally](const std::string& label) {
    ++tally.counts[std::find(kLabels, kLabels + 4, label) - kLabels];
  };
  ++tally.trials;
  if (contact.trial.touches.empty()) count(contact.trial.label);
  for (const Touch& touch : contact.trial.touches) count(touch.label);
  tally.clamped += contact.clamped;
  tally.never_felt += !flags.skin.empty() && !Detectable(contact.trial, layout);
}

const int (*CountsOfPaper(const std::string& protocol))[4] {
  for (const PaperCounts& paper : kPaperCounts) {
    if (protocol == paper.protocol) return &paper.counts;
  }
  return nullptr;
}

Json ToJson(const int (&counts)[4]) {
  Json json;
  for (int k = 0; k < 4; ++k) json[kLabels[k]] = counts[k];
  return json;
}

std::string Row(const char* name, const int (&counts)[4]) {
  return absl::StrFormat("%-6s %5d %5d %5d %5d   %5d\n", name, counts[0],
                         counts[1], counts[2], counts[3], Sum(counts));
}

// The goal of all trials of the paper's protocol; nothing if there are several.
std::optional<double> CommonGoal(const SimulateFlags& flags) {
  if (flags.protocol != "paper" || flags.goals.size() > 1) return {};
  return flags.goals.empty() ? kPaperGoal : flags.goals[0];
}

void Print(const SimulateFlags& flags, const Tally& tally) {
  const std::optional<double> goal = CommonGoal(flags);
  const int(*paper)[4] = CountsOfPaper(flags.protocol);
  if (flags.json) {
    Json json = {{"protocol", flags.protocol},
                 {"trials", tally.trials},
                 {"counts", ToJson(tally.counts)}};
    if (paper != nullptr) json["paper_counts"] = ToJson(*paper);
    json["undetectable"] = tally.never_felt;
    json["strain_clamped"] = tally.clamped;
    if (goal) json["goal_m"] = *goal;
    if (flags.scene.touches > 1) {
      json["touches"] = flags.scene.touches;
      json["gap_s"] = flags.scene.gap_s;
    }
    if (flags.scene.objects > 1) json["objects"] = flags.scene.objects;
    if (flags.alone) json["alone"] = true;
    if (flags.skin.empty()) {
      json["noise"] = NoiseOrDefault(flags.noise);
    } else {
      json["skin"] = flags.skin;
    }
    json["seed"] = flags.seed;
    json["seconds"] = SecondsSinceStart();
    std::cout << JsonText(json) << "\n";
    return;
  }
  std::cout << "          HU    HM    SU    SM   total\n"
            << Row("here", tally.counts);
  if (paper != nullptr) std::cout << Row("paper", *paper);
  std::cout << absl::StrFormat("%d never felt, %d with clamped strain, ",
                               tally.never_felt, tally.clamped);
  if (goal) std::cout << absl::StrFormat("goal %g m, ", *goal);
  std::cout << (flags.skin.empty()
                    ? absl::StrCat("ideal signals, noise ",
                                   NoiseOrDefault(flags.noise), ", ")
                    : absl::StrCat("skin ", flags.skin, ", "));
  std::cout << absl::StrFormat("seed %d, %.1f s\n", flags.seed,
                               SecondsSinceStart());
}

absl::Status RunSimulate(const SimulateFlags& flags) {
  TACTUS_ASSIGN_OR_RETURN(const SkinLayout layout, LayoutOf(flags));
  TACTUS_ASSIGN_OR_RETURN(const auto jobs, MakeJobs(flags, layout));
  std::optional<TrialFileWriter> writer;
  if (!flags.out.empty()) {
    TACTUS_ASSIGN_OR_RETURN(
        auto created, TrialFileWriter::Create(flags.out, {.overwrite = true}));
    writer.emplace(std::move(created));
  }
  const int limit =
      flags.protocol == "grid" ? flags.sample : std::numeric_limits<int>::max();
  ProgressDisplay display;
  const Progress simulating = display.progress().Part("simulate contacts", 1);
  // The grid ends after `sample` trials, the other protocols after all jobs.
  const bool grid = flags.protocol == "grid";
  const double all = grid ? flags.sample : static_cast<double>(jobs.count);
  Tally tally;
  for (size_t begin = 0; begin < jobs.count; begin += kBlock) {
    const size_t size = std::min(kBlock, jobs.count - begin);
    std::vector<absl::StatusOr<std::vector<SensedContact>>> block(size);
    RunOnThreads(static_cast<int>(size),
                 [&](int i) { block[i] = jobs.run(begin + i); });
    for (auto& contacts : block) {
      TACTUS_RETURN_IF_ERROR(contacts.status());
      simulating.Add((grid ? static_cast<double>(contacts->size()) : 1) / all);
      for (const SensedContact& contact : *contacts) {
        if (tally.trials == limit) break;
        Count(contact, flags, layout, tally);
        if (writer) TACTUS_RETURN_IF_ERROR(writer->Append(contact.trial));
      }
    }
    if (tally.trials == limit) break;
  }
  if (writer) TACTUS_RETURN_IF_ERROR(writer->Close());
  display.Clear();
  Print(flags, tally);
  return absl::OkStatus();
}

}  // namespace

void AddSimulate(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<SimulateFlags>();
  CLI::App* command =
      &AddVerb(app, "simulate", "Simulate an arm's contacts into a trial file",
               "simulate --protocol=paper --skin=good --out=sim.h5");
  command->add_option(
      "--protocol", flags->protocol,
      "paper (its 1,835 trials), grid (other robot conditions), cody (its "
      "robot experiment) or random (objects, arms and places of all kinds)");
  command->add_option("--contacts", flags->contacts,
                      "Number of trials of --protocol=random");
  CLI::Option* touches = command->add_option(
      "--touches", flags->scene.touches,
      "Contacts of each random trial: the arm lets go and touches another "
      "object");
  command
      ->add_option("--gap", flags->scene.gap_s,
                   "Seconds without load between two of --touches")
      ->needs(touches);
  command
      ->add_option("--objects", flags->scene.objects,
                   "Objects that press at overlapping times in each random "
                   "trial, up to 4")
      ->excludes(touches);
  command->add_flag("--alone", flags->alone,
                    "Write each contact of --touches or --objects as a trial "
                    "of its own, as if the others were not there");
  command->add_option("--touch-seconds", flags->scene.touch_s,
                      "Of --touches and --objects: seconds from a touch to its "
                      "lift-off");
  command->add_option("--skin", flags->skin,
                      "Skin that records the contacts: paper, good or measured "
                      "(docs/simulator.md); default: none, so that ideal "
                      "signals are written (with --protocol=random: good)");
  command
      ->add_option("--goal", flags->goals,
                   "Goals of the equilibrium point, m, instead of the "
                   "protocol's")
      ->delimiter(',');
  command->add_option(
      "--noise", flags->noise,
      "Noise of ideal signals: relative (a share of the variance of the "
      "trial's own signal, which gives away how large it becomes) or absolute "
      "(the same in every trial); default: relative");
  command->add_option("--seed", flags->seed, "Seed of every random choice");
  command->add_option("--out", flags->out, "Trial file to write");
  command
      ->add_option("--stiffness", flags->stiffnesses,
                   "Arm stiffnesses, N/m, instead of the protocol's")
      ->delimiter(',');
  command
      ->add_option("--velocity", flags->velocities,
                   "Arm speeds, m/s, instead of the protocol's")
      ->delimiter(',');
  command->add_option(
      "--materials", flags->materials,
      "CSV table of materials (as core/sim/model/materials.csv) "
      "instead of the paper's");
  command->add_option(
      "--sample", flags->sample,
      "Number of trials of the grid, evenly over its conditions");
  command->add_flag("--json", flags->json, "Print one JSON object on stdout");
  auto one = std::make_shared<OneContactFlags>();
  AddOneContactFlags(*command, *one);
  command->callback([=] {
    select([=] {
      // What only skins record is recorded by the skin of today's electronics.
      if (flags->protocol == "random" && flags->skin.empty()) {
        flags->skin = "good";
      }
      return one->scene.empty() ? RunSimulate(*flags)
                                : SimulateOne(*one, std::cout);
    });
  });
}

}  // namespace tactus::internal::client
