#include "core/contacts/world_contacts.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/contacts/touch_contacts.h"
#include "core/sim/exact/simulate_contact.h"
#include "core/sim/experiments/random_scene.h"
#include "core/sim/experiments/random_world.h"
#include "core/sim/experiments/world_draws.h"

namespace tactus::internal {
namespace {

constexpr absl::string_view kPrefix = "world:";
constexpr absl::string_view kIdeal = "ideal";
// Contacts that one task makes.
constexpr uint64_t kChunk = 64;
// Beyond it poses say nothing about any contact.
constexpr double kMaxPoseNoiseMm = 100;
// Which arms lift off, and when, comes from other streams than the contacts.
constexpr uint64_t kLiftOffStream = uint64_t{1} << 37;
constexpr double kFirstLiftOffS = 0.3;
constexpr double kLastLiftOffS = 5;

absl::Status SetSkins(absl::string_view names, WorldRecipe& recipe) {
  recipe.skins.clear();
  for (absl::string_view name : absl::StrSplit(names, '+')) {
    if (name != kIdeal) TACTUS_RETURN_IF_ERROR(SkinModelNamed(name).status());
    recipe.skins.emplace_back(name);
  }
  const auto ideal = std::ranges::count(recipe.skins, kIdeal);
  if (ideal > 0 && recipe.skins.size() > 1) {
    return InvalidConfig("skin", names, "ideal alone, or skins");
  }
  return absl::OkStatus();
}

absl::Status SetNumber(absl::string_view field, absl::string_view value,
                       uint64_t low, uint64_t high, uint64_t& number) {
  if (!absl::SimpleAtoi(value, &number) || number < low || number > high) {
    return InvalidConfig(field, value, absl::StrCat(low, " to ", high));
  }
  return absl::OkStatus();
}

absl::Status SetPoseNoise(absl::string_view value, WorldRecipe& recipe) {
  double millimetres = 0;
  // Written so that NaN is refused.
  if (!absl::SimpleAtod(value, &millimetres) ||
      !(millimetres >= 0 && millimetres <= kMaxPoseNoiseMm)) {
    return InvalidConfig("pose-noise", value,
                         absl::StrCat("0 to ", kMaxPoseNoiseMm, " mm"));
  }
  recipe.pose_noise_m = millimetres / 1000;
  return absl::OkStatus();
}

absl::Status SetLiftOffs(absl::string_view value, WorldRecipe& recipe) {
  // Written so that NaN is refused.
  if (!absl::SimpleAtod(value, &recipe.liftoffs) ||
      !(recipe.liftoffs >= 0 && recipe.liftoffs <= 1)) {
    return InvalidConfig("liftoffs", value, "0 to 1");
  }
  return absl::OkStatus();
}

absl::Status SetPart(absl::string_view part, WorldRecipe& recipe) {
  const std::pair<absl::string_view, absl::string_view> field =
      absl::StrSplit(part, absl::MaxSplits('=', 1));
  if (field.first == "skin") return SetSkins(field.second, recipe);
  if (field.first == "contacts") {
    return SetNumber(field.first, field.second, 1, limits::kMaxWorldContacts,
                     recipe.contacts);
  }
  if (field.first == "seed") {
    return SetNumber(field.first, field.second, 0, UINT64_MAX, recipe.seed);
  }
  if (field.first == "poses") {
    if (field.second != "yes" && field.second != "no") {
      return InvalidConfig("poses", field.second, "yes or no");
    }
    recipe.poses = field.second == "yes";
    return absl::OkStatus();
  }
  if (field.first == "pose-noise") return SetPoseNoise(field.second, recipe);
  if (field.first == "liftoffs") return SetLiftOffs(field.second, recipe);
  return InvalidConfig("part of the recipe", part,
                       "skin=..., contacts=..., seed=..., poses=..., "
                       "pose-noise=... or liftoffs=...");
}

// A skin that records, or none for ideal signals.
using Skins = std::vector<std::optional<SkinModel>>;

// A contact of an arm that lifts off: of those that the skin felt, the longest.
absl::StatusOr<std::optional<LabelledContact>> MakeLiftedContact(
    const WorldRecipe& recipe, const SkinModel& skin, uint64_t number,
    Random& random) {
  SceneOptions scene;
  scene.touch_s = LogUniformBetween(kFirstLiftOffS, kLastLiftOffS, random);
  TACTUS_ASSIGN_OR_RETURN(Trial trial,
                          SceneTrial(skin, scene, recipe.seed, number));
  if (!recipe.poses) trial.poses.clear();
  TACTUS_ASSIGN_OR_RETURN(
      TouchContacts found,
      ExtractContacts(
          trial, {.max_contacts = limits::kMaxContacts, .whole_skin = false}));
  if (found.contacts.empty()) return std::optional<LabelledContact>();
  LabelledContact& longest = *std::ranges::max_element(
      found.contacts, {},
      [](const LabelledContact& contact) { return contact.frames.size(); });
  longest.touch.reset();
  return std::optional(std::move(longest));
}

absl::StatusOr<std::optional<LabelledContact>> MakeContact(
    const WorldRecipe& recipe, const Skins& skins, uint64_t number) {
  const std::optional<SkinModel>& skin = skins[number % skins.size()];
  if (!skin) {
    TACTUS_ASSIGN_OR_RETURN(const Trial trial,
                            WorldSignals(recipe.noise, recipe.seed, number));
    return ExtractContact(trial);
  }
  Random random = Random::ForStream(recipe.seed, kLiftOffStream + number);
  if (random.Uniform() < recipe.liftoffs) {
    return MakeLiftedContact(recipe, *skin, number, random);
  }
  TACTUS_ASSIGN_OR_RETURN(Trial trial, WorldTrial(*skin, recipe.seed, number));
  if (!recipe.poses) trial.poses.clear();
  return ExtractContact(trial, {.whole_skin = false});
}

}  // namespace

bool IsWorldRecipe(absl::string_view text) {
  return absl::StartsWith(text, kPrefix);
}

absl::StatusOr<WorldRecipe> ParseWorldRecipe(absl::string_view text) {
  WorldRecipe recipe;
  if (!absl::ConsumePrefix(&text, kPrefix)) {
    return InvalidConfig("recipe", text, "world:...");
  }
  for (absl::string_view part : absl::StrSplit(text, ',', absl::SkipEmpty())) {
    TACTUS_RETURN_IF_ERROR(SetPart(part, recipe));
  }
  if (recipe.pose_noise_m &&
      (!recipe.poses || recipe.skins.front() == kIdeal)) {
    return InvalidConfig(
        "pose-noise", "given",
        "absent: ideal signals and contacts without poses have "
        "no noise of poses");
  }
  if (recipe.liftoffs > 0 && recipe.skins.front() == kIdeal) {
    return InvalidConfig("liftoffs", recipe.liftoffs,
                         "absent: ideal signals know of no release");
  }
  return recipe;
}

absl::StatusOr<WorldContacts> MakeWorldContacts(const WorldRecipe& recipe,
                                                const ParallelFor& parallel,
                                                const Progress& progress) {
  Skins skins;
  for (const std::string& name : recipe.skins) {
    skins.emplace_back();
    if (name == kIdeal) continue;
    TACTUS_ASSIGN_OR_RETURN(SkinModel skin, SkinModelNamed(name));
    if (recipe.pose_noise_m) {
      skin.pose_noise_min_m = skin.pose_noise_max_m = *recipe.pose_noise_m;
    }
    skins.back() = std::move(skin);
  }
  std::vector<std::optional<LabelledContact>> made(recipe.contacts);
  const auto chunks = static_cast<int>((recipe.contacts + kChunk - 1) / kChunk);
  std::vector<absl::Status> failures(chunks);
  const Progress simulating = progress.Part("simulate contacts", 1);
  parallel(chunks, [&](int chunk) {
    const uint64_t begin = chunk * kChunk;
    const uint64_t end = std::min(begin + kChunk, recipe.contacts);
    for (uint64_t n = begin; n < end && failures[chunk].ok(); ++n) {
      auto contact = MakeContact(recipe, skins, n);
      if (contact.ok()) {
        made[n] = *std::move(contact);
      } else {
        failures[chunk] =
            Annotate(contact.status(), absl::StrCat("contact ", n));
      }
    }
    simulating.Add(1.0 / chunks);
  });
  for (const absl::Status& failure : failures) {
    TACTUS_RETURN_IF_ERROR(failure);
  }
  WorldContacts world;
  world.recorded.resize(skins.size());
  world.never_felt.resize(skins.size());
  for (uint64_t n = 0; n < recipe.contacts; ++n) {
    ++world.recorded[n % skins.size()];
    if (made[n]) {
      world.contacts.push_back(*std::move(made[n]));
      made[n].reset();
    } else {
      ++world.never_felt[n % skins.size()];
    }
  }
  return world;
}

}  // namespace tactus::internal
