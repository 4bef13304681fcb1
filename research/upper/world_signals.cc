// world-signals: writes contacts of the random world, or of a trial file, as
// arrays, for learners of other programs (upper_reference.py).
//
//   world-signals --data=world:skin=good,contacts=1000,seed=2 --out=a
//   world-signals --data=softer.h5 --out=b
//
// | array | shape | meaning |
// |---|---|---|
// | label | N | class in the end |
// | material | N | name of the material |
// | condition | N | name of the robot condition |
// | felt | N x 500 x 4 | largest taxel (N), area (m^2), motion (m), net force |
// | onset | N | frames from the touch to the onset |
// | moved | N | frames since onset until the object has moved by kMovedM |
// | true | N x 500 x 3 | force, area and motion since the touch, no noise |
// | cues | N x 6 x C | derived cues at kAnytimeSeconds; C names in cue_names |
// | posterior | N x 6 x 4 | answers of --model at those times |
//
// `felt` counts from the onset and is NaN where the object is not touched or
// after the end. `onset` is below 0 if the skin felt something earlier, and 0
// for a trial file, of which `true` is NaN. `moved` is -1 if it never moves.
//
// Each array is a file, felt.npy and so on, in the folder --out. Only felt
// contacts are written; `recorded` is how many contacts there were.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/base/limits.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "core/classify/contact_classifier.h"
#include "core/contacts/anytime.h"
#include "core/contacts/world_contacts.h"
#include "core/data/trial_file.h"
#include "core/files/file_bytes.h"
#include "core/files/npy_write.h"
#include "core/sim/experiments/random_world.h"

namespace tactus::internal {
namespace {

constexpr size_t kFrames = 500;
constexpr size_t kFelt = 4;
constexpr size_t kTrue = kFeatureCount;
constexpr size_t kClasses = 4;
constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

struct WorldFlags {
  std::string data;
  std::string model;
  std::string out;
};

// One row of each array for every contact.
struct Arrays {
  Arrays(size_t contacts, size_t cue_count)
      : felt(contacts * kFrames * kFelt, kNothing),
        truth(contacts * kFrames * kTrue, kNothing),
        onset(contacts),
        moved(contacts),
        cues(contacts * kAnytimeCount * cue_count),
        posterior(contacts * kAnytimeCount * kClasses) {}

  std::vector<float> felt, truth, onset, moved, cues, posterior;
};

void WriteFelt(const LabelledContact& contact, size_t row, Arrays& arrays) {
  arrays.moved[row] = -1;
  const bool known = !contact.object_motion.empty();
  for (size_t t = 0; t < std::min(contact.frames.size(), kFrames); ++t) {
    if (known && arrays.moved[row] < 0 && contact.object_motion[t] > kMovedM) {
      arrays.moved[row] = static_cast<float>(t);
    }
    if (!contact.frames.touched(t)) continue;
    float* at = &arrays.felt[(row * kFrames + t) * kFelt];
    for (double value : contact.frames.features(t)) {
      *at++ = static_cast<float>(value);
    }
    *at = static_cast<float>(contact.frames.net_force(t));
  }
}

absl::Status WriteTruth(const WorldRecipe& recipe,
                        const LabelledContact& contact, size_t row,
                        Arrays& arrays) {
  uint64_t number = 0;
  if (!absl::SimpleAtoi(contact.id, &number)) {
    return absl::InternalError(contact.id);
  }
  TACTUS_ASSIGN_OR_RETURN(
      const Trial exact,
      WorldSignals({.force = 0, .area = 0, .motion = 0}, recipe.seed, number));
  for (size_t t = 0; t < std::min(exact.signals.size(), kFrames); ++t) {
    for (size_t f = 0; f < kTrue; ++f) {
      arrays.truth[(row * kFrames + t) * kTrue + f] =
          static_cast<float>(exact.signals[t][f]);
    }
  }
  arrays.onset[row] = static_cast<float>(
      static_cast<double>(exact.signals.size()) - contact.frames.size());
  return absl::OkStatus();
}

void WriteCues(const LabelledContact& contact, size_t row,
               const std::vector<Cue>& cues, Arrays& arrays) {
  const auto due = AnytimeFrames(contact.sample_rate_hz);
  CueTracker tracker(contact.sample_rate_hz);
  const auto write = [&](int time) {
    for (size_t c = 0; c < cues.size(); ++c) {
      arrays.cues[(row * kAnytimeCount + time) * cues.size() + c] =
          static_cast<float>(tracker.value(cues[c]));
    }
  };
  int next = 0;
  for (size_t t = 0; t < contact.frames.size(); ++t) {
    if (contact.frames.touched(t)) {
      tracker.Step(contact.frames[t].sample, t + 1);
    }
    for (; next < kAnytimeCount && t + 1 >= due[next]; ++next) write(next);
  }
  for (; next < kAnytimeCount; ++next) write(next);
}

void WriteAnswers(const std::shared_ptr<const CompiledModel>& model,
                  const LabelledContact& contact, size_t row, Arrays& arrays) {
  ContactClassifier classifier(model, {});
  WalkContact(contact, classifier, [&](int time) {
    const size_t at = row * kAnytimeCount + time;
    for (size_t k = 0; k < kClasses; ++k) {
      arrays.posterior[at * kClasses + k] =
          static_cast<float>(classifier.probability()[k]);
    }
  });
}

// The contacts that the skin felt.
struct Felt {
  std::vector<LabelledContact> contacts;
  uint64_t recorded = 0;
};

absl::StatusOr<Felt> ReadTrials(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(auto reader, TrialFileReader::Open(path));
  Felt felt = {.contacts = {}, .recorded = reader.size()};
  for (size_t i = 0; i < reader.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(const Trial trial, reader.Read(i));
    TACTUS_ASSIGN_OR_RETURN(auto contact,
                            ExtractContact(trial, {.whole_skin = false}));
    if (contact) felt.contacts.push_back(*std::move(contact));
  }
  return felt;
}

absl::Status Run(const WorldFlags& flags) {
  std::optional<WorldRecipe> recipe;
  if (IsWorldRecipe(flags.data)) {
    TACTUS_ASSIGN_OR_RETURN(recipe, ParseWorldRecipe(flags.data));
  }
  std::shared_ptr<const CompiledModel> model;
  if (!flags.model.empty()) {
    TACTUS_ASSIGN_OR_RETURN(
        const std::string bytes,
        ReadFileBytes(flags.model, limits::kMaxBundleBytes));
    TACTUS_ASSIGN_OR_RETURN(model, DecodeBundle(bytes));
  }
  Felt felt;
  if (recipe) {
    TACTUS_ASSIGN_OR_RETURN(WorldContacts world,
                            MakeWorldContacts(*recipe, RunOnThreads));
    felt = {std::move(world.contacts), recipe->contacts};
  } else {
    TACTUS_ASSIGN_OR_RETURN(felt, ReadTrials(flags.data));
  }
  const std::vector<LabelledContact>& contacts = felt.contacts;
  const std::vector<Cue> cues = StandardCues();
  Arrays arrays(contacts.size(), cues.size());
  std::vector<absl::Status> failures(contacts.size());
  RunOnThreads(static_cast<int>(contacts.size()), [&](int i) {
    WriteFelt(contacts[i], i, arrays);
    if (recipe) failures[i] = WriteTruth(*recipe, contacts[i], i, arrays);
    WriteCues(contacts[i], i, cues, arrays);
    if (model) WriteAnswers(model, contacts[i], i, arrays);
  });
  for (const absl::Status& failure : failures) TACTUS_RETURN_IF_ERROR(failure);

  std::vector<std::string> labels;
  std::vector<std::string> materials;
  std::vector<std::string> conditions;
  for (const LabelledContact& contact : contacts) {
    labels.push_back(contact.label);
    materials.push_back(contact.material);
    conditions.push_back(contact.condition);
  }
  std::vector<std::string> cue_names;
  for (Cue cue : cues) cue_names.emplace_back(CueName(cue));
  const size_t n = contacts.size();
  const auto floats = [](const std::vector<size_t>& shape,
                         std::vector<float>& values) {
    std::string bytes = NpyBytes(shape, std::span<const float>(values));
    std::vector<float>().swap(values);
    return bytes;
  };
  std::vector<std::pair<std::string, std::string>> files = {
      {"label", NpyText(labels)},
      {"material", NpyText(materials)},
      {"condition", NpyText(conditions)},
      {"cue_names", NpyText(cue_names)},
      {"recorded",
       NpyBytes({}, std::vector<double>{static_cast<double>(felt.recorded)})},
      {"felt", floats({n, kFrames, kFelt}, arrays.felt)},
      {"true", floats({n, kFrames, kTrue}, arrays.truth)},
      {"onset", floats({n}, arrays.onset)},
      {"moved", floats({n}, arrays.moved)},
      {"cues", floats({n, kAnytimeCount, cues.size()}, arrays.cues)},
  };
  if (model) {
    files.emplace_back("posterior",
                       floats({n, kAnytimeCount, kClasses}, arrays.posterior));
  }
  std::filesystem::create_directories(flags.out);
  for (const auto& [name, bytes] : files) {
    const std::string path = absl::StrCat(flags.out, "/", name, ".npy");
    std::ofstream file(path, std::ios::binary);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!file.flush()) return absl::UnavailableError(path);
  }
  return absl::OkStatus();
}

int Main(int argc, char** argv) {
  CLI::App app(
      "Writes contacts of the random world, or of a trial file, as arrays.",
      "world-signals");
  WorldFlags flags;
  app.add_option("--data", flags.data,
                 "world:skin=...,contacts=...,seed=..., or a trial file")
      ->required();
  app.add_option("--out", flags.out, "Folder for the arrays")->required();
  app.add_option("--model", flags.model,
                 "Bundle whose answers are written too");
  CLI11_PARSE(app, argc, argv);
  const absl::Status status = Run(flags);
  if (status.ok()) return 0;
  std::fprintf(stderr, "world-signals: %s\n", status.ToString().c_str());
  return 1;
}

}  // namespace
}  // namespace tactus::internal

int main(int argc, char** argv) { return tactus::internal::Main(argc, argv); }
