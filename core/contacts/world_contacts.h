// File: world_contacts.h
//
// Labelled contacts of the random world (core/sim/experiments/random_world.h),
// made when they are asked for. Each contact is simulated, recorded by a skin
// and followed by the feature path; its frames of taxels are then dropped. So
// 100,000 contacts take no disk, and 8 kB of memory each.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const WorldRecipe recipe,
//       ParseWorldRecipe("world:skin=good+measured,contacts=100000,seed=1"));
//   TACTUS_ASSIGN_OR_RETURN(const WorldContacts world,
//                           MakeWorldContacts(recipe, RunSerially));
//
// The same recipe gives the same contacts, however `parallel` spreads the work.
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/base/work.h"
#include "core/contacts/labelled_contact.h"
#include "core/sim/skin/signals.h"

namespace tactus::internal {

struct WorldRecipe {
  // Names of skins (skin_model.h), or "ideal" for signals without a skin.
  // Contact n is recorded by skin n modulo their number.
  std::vector<std::string> skins = {"good"};
  uint64_t contacts = 1000;
  uint64_t seed = 1;
  // Noise of ideal signals.
  SignalNoise noise;
  // Without poses the motion is that of the centroid along the skin.
  bool poses = true;
  // Standard deviation of each coordinate of a pose, m, the same in all
  // contacts. If absent, each contact draws its own.
  std::optional<double> pose_noise_m;
  // Share of contacts in which the arm lifts off, 0.3 to 5 s after the touch
  // (log-uniform). Their objects and arms are not those of the same number
  // without a lift-off, and they last until a server would release them.
  double liftoffs = 0;
};

// True if `text` names a recipe and not a file.
bool IsWorldRecipe(absl::string_view text);

// Parses "world:" and any of skin=NAME+NAME, contacts=N, seed=S, poses=yes|no,
// pose-noise=MILLIMETRES, liftoffs=SHARE, separated by commas. INVALID_CONFIG,
// which names the part, also if pose-noise is given where there are no noisy
// poses, or liftoffs without a skin.
absl::StatusOr<WorldRecipe> ParseWorldRecipe(absl::string_view text);

struct WorldContacts {
  std::vector<LabelledContact> contacts;
  // How many of the recipe's contacts each of its skins recorded, and how many
  // of those it never felt.
  std::vector<uint64_t> recorded;
  std::vector<uint64_t> never_felt;
};

absl::StatusOr<WorldContacts> MakeWorldContacts(const WorldRecipe& recipe,
                                                const ParallelFor& parallel,
                                                const Progress& progress = {});

}  // namespace tactus::internal
